"""Drafts of cards for robots that have none: legs, groups, posture and servos."""
