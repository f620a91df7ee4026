"""Meshes of small objects: food, tableware, toys."""
