"""Bodies of people and robots in the MuJoCo model."""
