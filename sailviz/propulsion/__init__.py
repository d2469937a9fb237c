"""The force of one device."""
