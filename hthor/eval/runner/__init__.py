"""Playing a run's trials in worker processes and collecting their records."""
