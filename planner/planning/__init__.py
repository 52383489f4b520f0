"""Sec. 5.2: from a path to a plan, and its rollout, eq. (12); replanning, shooting."""
