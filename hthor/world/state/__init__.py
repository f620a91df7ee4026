"""What changes during a trial: bodies, objects, doors, rooms."""
