"""Arrays, polynomials at nodes, linear subspaces, budgets of time, interruption."""
