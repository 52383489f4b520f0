"""Tables of walks for studies, written by hand."""

from sim.studies.results import Results


def results(shares, **columns):
    """Walks of a path of 2 m that came off by shares of it; None was no walk."""
    count = len(shares)
    table = {
        "point": list(range(count)),
        "status": ["no way" if s is None else "ok" for s in shares],
        "error.ideal.farthest": [None if s is None else 2.0 * s for s in shares],
        "path_length": [None if s is None else 2.0 for s in shares],
        "distance_walked": [None if s is None else 9.0 for s in shares],
        "verdict": [None if s is None else "arrived" for s in shares],
        "a": [float(k) for k in range(count)],
        **columns,
    }
    return Results(
        table, tuple(k for k in ("a", "b") if k in table), "ideal", judge="ideal"
    )
