"""`hthor calibrate`."""
