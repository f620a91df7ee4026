"""`hthor humans validate`: simulated study groups compared with the published figures; begin with `run`."""
