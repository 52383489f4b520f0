"""Sec. 5.2: from a path to a plan; rollout, replanning, shooting, plan files."""
