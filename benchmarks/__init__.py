"""Timings, which belong here and never in a test."""
