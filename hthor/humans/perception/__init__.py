"""What a participant notices of what is in view. Begin with `perception.Eyes`."""
