"""Comparing runs: paired differences, rankings, populations, sample sizes."""
