"""Floor plans, trials, timelines and videos as pictures."""
