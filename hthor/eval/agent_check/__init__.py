"""`hthor agent check`: checks whether an agent follows its contract."""
