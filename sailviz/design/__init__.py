"""Closed forms and solvers: the orbit first, then the sail that flies it."""
