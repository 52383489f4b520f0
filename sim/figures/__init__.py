"""The paper's Figs. 1 to 9 drawn again, on its kinematics and beside the physics.

Each has two sheets: `paper` in the paper's units (l = 1) and `metres` with physics
beside the prediction.
"""

NAMES = (
    *("mechanism", "biped", "quadruped", "sequence", "panels"),
    *("stability", "line", "ellipse", "diagonal", "corridor"),
)  # their modules have `paper(axes)`, `metres(axes, walks)` and the `WALKS` of these
