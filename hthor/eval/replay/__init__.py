"""Logged trials run again: `rerun` with the agents as they are now, `human_trace` to see what the human thought."""
