"""Stratified motion planning: from a path in space to footfalls and joint inputs.

The paper is Goodwine and Burdick, "Quasi-Static Legged Locomotors as Nonholonomic
Systems", IROS 2000; equation, section and figure numbers in this project are its.
"""
