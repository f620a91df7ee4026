"""`hthor tasks`."""
