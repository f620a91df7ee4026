"""The person's avatar as far as tasks need it: an all-knowing person with this body sets T*."""

RADIUS_M = 0.20
HEIGHT_M = 1.75
EYE_M = 1.6
REACH_M = 1.2
"""Horizontal reach [m] from the body's axis, to an object's centre or to the nearest point of a surface."""
START_MARGIN_M = 0.30
"""Free floor around the place where any body starts."""
