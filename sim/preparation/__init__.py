"""Everything that can be decided before the first physics step."""
