"""Robots, one file each, found by file name: ``SPEC`` says what the body can do, ``look()`` gives its solids.

The body frame has x ahead, y left, z up, and its origin on the floor below the axis.
"""
