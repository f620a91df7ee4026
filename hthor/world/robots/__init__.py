"""Robots, one file each, found by file name; ``docs/robots.md`` says how to add one.

``SPEC`` says what the body can do and ``look()`` returns its solids in the body frame: x ahead, y left, z up, origin on
the floor below the axis. Optional are ``NECK`` [m], the point about which its head turns, ``HAND`` [m], the point where
the lowest point of a held object rests, and ``pieces()``, its meshes in pictures for people.
"""
