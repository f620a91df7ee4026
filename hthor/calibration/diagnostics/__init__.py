"""Checks of a calibration: coverage, held-out prediction, robustness of the ranking, acceptance criteria."""
