"""Joining the shards of one run."""
