"""Suites of tasks: those that ship, secret ones, and one's own."""
