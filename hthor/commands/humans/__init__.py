"""`hthor humans`."""
