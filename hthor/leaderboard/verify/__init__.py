"""Verification: entries replayed and compared, and their agents run on fresh tasks."""
