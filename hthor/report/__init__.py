"""Pages and figures for people: their look, what they are made of, and those that tell of runs; plays nothing."""
