"""Draws floor plans, trials, timelines and videos."""
