"""Picking, placing and opening: what actions do to the scene."""
