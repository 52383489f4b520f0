"""Physics, measurement, pictures and the command line."""
