"""Meshes of furniture, appliances and fixtures."""
