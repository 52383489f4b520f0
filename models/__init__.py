"""Robots: a body in MJCF, a card that names its parts, and the equations of both.

====================================  ================================================
From file to robot                    library, card, card_file, robot
Can it be one                         parts, posture, lifting, soles, poise, replicas
Its equations, eqs. (16)-(18)         equations, strokes, twists, integral
Quasi-static contact kinematics       kinematics, loads, dissipation, sliding, ground
As measured                           identified
The shipped robots                    shapes, morphology, mjcf
Systems without a body                systems
====================================  ================================================
"""
