"""What a participant keeps in mind during a trial. Begin with `spatial_memory` and `subgoals`."""
