"""Entries played again, compared, and tried on fresh tasks."""
