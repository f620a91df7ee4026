"""Routes through a house, from a start to a landmark, and instructions that describe them."""
