"""Runs against each other: paired differences, rankings, populations, sample sizes."""
