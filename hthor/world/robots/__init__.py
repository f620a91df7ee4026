"""Robots, one file each, found by file name; ``docs/robots.md`` says how to add one.

``SPEC`` says what the body can do and ``look()`` gives its solids in the body frame: x ahead, y left, z up, origin on
the floor below the axis. ``NECK`` [m], where its head turns, ``HAND`` [m], where the lowest point of what it holds
rests, and ``pieces()``, its meshes for pictures for people, may be left out.
"""
