"""Many flights at once, each through a wind of its own."""
