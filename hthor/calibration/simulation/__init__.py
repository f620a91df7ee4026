"""Simulated sessions for calibration, their store, and the table of their outcomes; begin with `simulate`."""
