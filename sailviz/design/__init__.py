"""Closed forms and solvers: from a wish to the device and attitude that fulfil it."""
