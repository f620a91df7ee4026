"""Estimates human parameters from the logs of trials; begin with `run`."""
