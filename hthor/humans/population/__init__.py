"""Distributions over people: parameters, priors, populations and their files."""
