"""`hthor leaderboard`."""
