"""Runs and trials as lists, for people who look through them."""
