"""Shapes: what a craft and a planet look like, as trimesh meshes; knows nothing of scenes, recordings or time."""
