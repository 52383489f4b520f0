"""Stratified motion planning: from a path in space to footfalls and joint inputs.

The paper is Goodwine and Burdick, "Quasi-Static Legged Locomotors as Nonholonomic
Systems", IROS 2000; equation, section and figure numbers in this project are its.
Public names are imported from here, `from planner import plan`, and loaded when they
are first used; `__init__.pyi` lists them. The rooms behind this door follow the paper:

==========  ==================  ====================================  ================
Paper       Notation            In the code                           Room
==========  ==================  ====================================  ================
eq. (1)     g_i, [g_1, g_2]     VectorField, bracket                  systems
eq. (2)     phi_t^g = e^{t g}   Flow, flow_map; formally Tensor.exp   systems; lie
eq. (3)     e^{g_1} e^{g_2}     LieAlgebra.campbell_baker_hausdorff   lie
eq. (4)     b_i                 extend                                extension
eq. (5)     v^i                 ExtendedSystem.fictitious_inputs      extension
eq. (6)     B_i                 hall_basis                            lie
eq. (6)     h_i                 backward, forward                     lie
eq. (7)     S' = S (B_i v_i)    backward                              lie
eq. (8)     Ad                  LieAlgebra.adjoint_action             lie
eq. (9)     h' = A(h) v         backward_matrix, integrate            lie
Def. 1      Phi_i, S_I          LevelSet, StratifiedSystem            systems
eq. (10)    g_{I,j}             StratifiedSystem.strata               systems
eq. (11)    gait                Gait                                  systems
Sec. 4      D_i                 gait_controllability                  controllability
eq. (12)    lift, flow, land    contact_switches, Plan.flows          systems, planning
eq. (13)    [g_11, g_12] = 0    require_decoupled                     controllability
eq. (14)    flows on S_B        on_bottom, tangent_field              controllability
eq. (15)    Def. 3              ExtendedSystem, extend                extension
(16)-(18)   the hexapod         equations                             models.motion
eq. (19)    its elements        Equations.elements                    models.motion
eq. (20)    real inputs         word                                  lie
Sec. 5.2    the algorithm       plan, Plan                            planning
Sec. 5.2    regrouping          regroup                               systems
==========  ==================  ====================================  ================
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
