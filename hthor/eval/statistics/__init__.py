"""Intervals, variance components, power and resampling."""
