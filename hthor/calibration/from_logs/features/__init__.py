"""Features of walking, manipulation and messages from one trial's log."""
