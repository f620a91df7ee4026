"""Logged trials run again: `session_history` with agents as they are now, `human_trace` to see the human's thoughts."""
