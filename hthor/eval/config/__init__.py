"""The configuration of a run: `run_config` is the whole of it; beside it robots, humans, tasks and sessions."""
