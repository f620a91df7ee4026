"""The state that changes during a trial: bodies, objects, doors, rooms."""
