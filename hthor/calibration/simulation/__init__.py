"""Simulated sessions for calibration: where, with whom, and the table of their outcomes."""
