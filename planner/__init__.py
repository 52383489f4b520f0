"""Stratified motion planning: from a path in space to footfalls and joint inputs.

The paper is Goodwine and Burdick, "Quasi-Static Legged Locomotors as Nonholonomic
Systems", IROS 2000; equation, section and figure numbers in this project are its.

=========================  ====================================  =======================
In the paper               In the code                           Where
=========================  ====================================  =======================
g_i         eq. (1)        VectorField, StratifiedSystem.fields  planner.strata
[g_1, g_2]  Sec. 2         bracket                               planner.fields
phi_t^g     Sec. 2         Flow, flow_map                        planner.flows
B_i         eq. (6)        Element, hall_basis                   planner.hall
[B_i, B_j]  Sec. 2         LieAlgebra.bracket                    planner.free_lie
Ad          eq. (8)        LieAlgebra.adjoint_action             planner.free_lie
e^g1 e^g2   eq. (3)        LieAlgebra.campbell_baker_hausdorff   planner.free_lie
S, e^g      eqs. (2), (6)  Tensor, Tensor.exp, Tensor.log        planner.tensor
A(h)        eq. (9)        backward_matrix, integrate            planner.coordinates
h, backward eq. (6)        hall_coordinates, backward            planner.coordinates
h, forward  Sec. 2.1       forward                               planner.coordinates
real inputs Sec. 2.1       word, words                           planner.realise
v^i         eq. (5)        fictitious_inputs                     planner.extended
S_I, Phi_i  Sec. 3         StratifiedSystem, LevelSet            planner.strata
G           eq. (11)       Gait                                  planner.strata
D_i         Sec. 4         gait_controllability                  planner.controllability
g~          Sec. 5.1       tangent_field                         planner.tangency
b_i         eq. (15)       ExtendedSystem, extend                planner.extended
gamma       Sec. 5.2       Path                                  planner.paths
algorithm   Sec. 5.2       plan, Plan                            planner.plan
=========================  ====================================  =======================
"""
