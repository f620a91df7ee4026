"""`hthor eval`."""
