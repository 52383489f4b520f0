from .gaits import (
    MAX_DEPTH as MAX_DEPTH,
    Controllability as Controllability,
    gait_controllability as gait_controllability,
)
