"""The stages of `hthor calibrate`, their cache, progress and summary."""
