"""Runs of many trials: configuring, running, scoring, comparing and replaying them."""
