"""What a run is of: its configuration, robots, people, tasks and sessions."""
