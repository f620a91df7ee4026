"""Messages, pipes and shared memory between host and guest. Begin with `wire`."""
