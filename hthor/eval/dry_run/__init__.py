"""`hthor eval --dry-run`: what a command would do and how long it would take."""
