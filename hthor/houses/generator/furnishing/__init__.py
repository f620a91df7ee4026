"""Furniture and small objects of a generated house."""
