"""Computes a run's result from its records."""
