"""Arrays, polynomials by their values at nodes, and linear subspaces."""
