"""`hthor merge`: joining the shards of one run."""
