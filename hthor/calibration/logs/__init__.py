"""Parameters of people from the logs of their trials; knows nothing of whether they were live or simulated."""
