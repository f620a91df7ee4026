"""hthor from Python: `evaluate` is `hthor eval` as a function, for scripts and notebooks."""
