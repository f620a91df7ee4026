"""Fits the human model to published results and to logs, and validates it; begin with `pipeline.run` or `validation.run`."""
