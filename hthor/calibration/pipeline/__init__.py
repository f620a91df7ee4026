"""`hthor calibrate` on published numbers: configuration, stages, evidence and results; begin with `run`."""
