"""Houses proven in the engine: drops, penetration, soundness."""
