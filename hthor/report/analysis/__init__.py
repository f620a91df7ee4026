"""Computes the contents of a report from runs; makes no HTML."""
