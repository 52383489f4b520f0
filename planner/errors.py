"""What the planner can refuse, each with the value, the place and the way out."""


class PlannerError(Exception):
    """A request that the mathematics cannot serve; the root of this package's errors.

    Bad arguments (wrong shapes, unknown names, NaN) are ``ValueError`` instead.
    """
