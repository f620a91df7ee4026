"""Parameters of people from the logs of their trials."""
