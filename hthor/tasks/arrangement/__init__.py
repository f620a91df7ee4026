"""Places a task's objects: surfaces, reach, sight and the scene priors. Begin with `target_arrangement`."""
