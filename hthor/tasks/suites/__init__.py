"""Suites of tasks: shipped suites, secret suites, and a user's own."""
