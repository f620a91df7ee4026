"""Fits the human model to published results and to logs, and validates it; see `pipeline.run`, `validation.run`."""
