"""A language model that decides in a participant's place. Begin with `policy`."""
