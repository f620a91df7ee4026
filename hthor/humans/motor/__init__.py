"""How a participant walks, stands, approaches things and handles them."""
