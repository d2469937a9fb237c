"""The compiled propagator: one right-hand side, one integrator, events."""
