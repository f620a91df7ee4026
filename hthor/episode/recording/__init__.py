"""The log of a trial while it is written: events, paths, set-points and rest times."""
