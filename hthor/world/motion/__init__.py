"""How bodies move, reach, collide and where they start."""
