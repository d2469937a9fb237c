"""One right-hand side, its integrators, and ensembles of flights."""
