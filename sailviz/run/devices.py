"""Devices by their words in scenes, and what a label calls them."""

from __future__ import annotations

LABELS = {
    "solar-sail": "Solar sail",
    "electric-sail": "E-sail",
    "plasma-brake": "Plasma brake",
    "thruster": "Thruster",
    "none": "Spacecraft",
}
SAILS = ("solar-sail", "electric-sail")  # what can be stowed
