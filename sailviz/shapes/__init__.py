"""Shapes: what a craft and a planet look like, as trimesh meshes, and what light and air do to a craft of such a shape;
knows nothing of scenes, recordings or time."""
