"""The configuration of a run: `run_config` has all of it; other files resolve robots, humans, tasks and sessions."""
