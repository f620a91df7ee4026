"""Figures that show a house in three dimensions, from outside and above, with marks drawn over it."""
