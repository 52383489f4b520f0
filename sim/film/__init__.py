"""Films of finished walks: drawn off-screen from a run folder, in other processes.

`direction` is the way in. `story` reads the run, `clock`, `camera`, `marks`, `ink`,
`captions` and `words` say what is seen, `scenery` and `stage` draw it, `crew`, `worker`
and `file` see to it that a film is whole or absent.
"""
