"""`hthor runs`, and the commands that join and convert the files of runs."""
