"""Checks whether a house is sound: structure, floor plan and furniture, judged by rules."""
