"""Converts runs and logs of the last release to log 1.0. Begin with `migrate`, which does it for `hthor migrate`."""
