"""How bodies move, reach and collide, and where they start."""
