"""What a person remembers of places and objects, and what is left to do."""
