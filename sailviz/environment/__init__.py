"""What surrounds the craft: gravity, solar wind, ionosphere. Knows nothing of scenes, recordings or time loops."""
