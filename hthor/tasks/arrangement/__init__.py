"""Where a task's objects lie: surfaces, reach, sight and the scene priors. Begin with `target_arrangement`."""
