"""From one trial's record to its metrics."""
