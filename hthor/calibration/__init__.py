"""Fitting the human model to published results and to logs, and checking it."""
