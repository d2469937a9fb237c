"""How sure an arrival is: winds fitted, chaos expanded, ensembles flown, control judged."""
