"""How sure an arrival is in the real wind: laws fitted and drawn, chaos expansions, covariances, voltage control."""
