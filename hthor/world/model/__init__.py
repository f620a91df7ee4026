"""The MuJoCo model of a house: geoms, props, doors and their index."""
