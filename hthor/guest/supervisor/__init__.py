"""The process between host and agent: it forks a fresh process for each trial and watches it."""
