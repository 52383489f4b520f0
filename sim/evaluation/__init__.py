"""A walk beside its predictions: errors, their sources, contacts, clearance."""
