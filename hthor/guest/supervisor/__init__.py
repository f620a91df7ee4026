"""The trusted process between host and agent: forks a new process for each trial and watches it."""
