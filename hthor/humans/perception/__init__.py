"""Which of the things in view a participant notices. Begin with `perception.Eyes`."""
