"""The emulator: a network ensemble that predicts trial outcomes from human parameters."""
