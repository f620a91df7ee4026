"""Are tasks sound? Each is solved by an omniscient person before it is given out."""
