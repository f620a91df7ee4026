"""`hthor humans validate`: simulated study groups against the published figures."""
