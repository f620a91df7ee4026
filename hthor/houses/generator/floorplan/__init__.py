"""Outline, rooms and doors of a generated house."""
