"""Stratified motion planning: from a path in space to footfalls and joint inputs.

The paper is Goodwine and Burdick, "Quasi-Static Legged Locomotors as Nonholonomic
Systems", IROS 2000. Equation, section and figure numbers throughout this project are
those of the paper. Public names are imported from here, `from planner import plan`, and
are loaded when they are first used; `__init__.pyi` lists them. The rooms behind this
front door follow the paper. Each has a door of its own with the names that `models` and
`sim` need in addition, such as `from planner.optimisation import Task`; those of the
table that are not here are there. Rooms beside the paper are `execution` (how plans are
carried out), `optimisation` (shorter plans), and for all others `numerics`, `support`.

=========  ============  ===================================  ==========================
Paper      Notation      In the code                          Room and module
=========  ============  ===================================  ==========================
eq. (1)    g_i, [f, g]   VectorField, bracket                 systems/fields
eq. (2)    phi_t^g       Flow, flow_map                       systems/flows
eq. (2)    e^{t g}       Tensor.exp                           lie/tensor
eq. (3)    e^g_1 e^g_2   LieAlgebra.campbell_baker_hausdorff  lie/free_lie
eq. (4)    b_i           extend                               extension/extended
eq. (5)    v^i           ExtendedSystem.fictitious_inputs     extension/extended
eq. (6)    B_i           hall_basis                           lie/hall
eq. (6)    h_i           backward, forward                    lie/coordinates
eq. (7)    S' = S B v    coordinate_rates                     lie/coordinates
eq. (8)    Ad            adjoint_action                       lie/coordinates
eq. (9)    h' = A(h) v   backward_matrix, integrate           lie/coordinates
Sec. 2.1   step length   critical_step                        planning/critical_steps
Def. 1     Phi_i         LevelSet                             systems/level_sets
Def. 1     S_I           StratifiedSystem                     systems/strata
eq. (10)   g_{I,j}       StratifiedSystem.strata              systems/strata
eq. (11)   gait          Gait                                 systems/flows
Sec. 4     D_i           gait_controllability                 controllability/gaits
eq. (12)   six flows     rollout                              planning/rollouts
eq. (13)   [g_11, g_12]  require_decoupled                    extension/fields_on_bottom
eq. (14)   flows on S_B  on_bottom, tangent_field             extension/fields_on_bottom
eq. (15)   Def. 3        ExtendedSystem, extend               extension/extended
(16)-(19)  the hexapod   models.paper_hexapod                 models/systems/legged
eq. (20)   u_1 o u_2     word                                 lie/input_words
Sec. 5.2   algorithm     plan, Plan                           planning/algorithm
Sec. 5.2   regrouping    regroup                              systems/grouping
Sec. 5.2   step length   subdivide                            planning/subdivision
=========  ============  ===================================  ==========================

The same equations for the body of a robot, (16) to (19), are `models.equations`, in
`models/motion/robot_equations`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
