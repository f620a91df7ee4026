"""The free space, lines of sight and walking distances of bodies in a house at rest."""
