"""What surrounds a craft: gravity, sunlight, wind, plasma, air and shadow."""
