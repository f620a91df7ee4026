"""What every part of a human model shares: the trial's context, jobs, the behaviour log."""
