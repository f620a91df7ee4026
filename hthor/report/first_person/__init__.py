"""Trials through the eyes of a person or a robot, as videos and as strips of pictures."""
