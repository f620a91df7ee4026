"""The leaderboard: runs as entries that anybody can check, a ranked list of the entries, and a page.

An entry is one file. It contains the outcome of every trial and a hash of every trial's record. So its numbers and the
ranks are computed from entries alone, and any trial can later be replayed and compared. Begin reading with
`hthor.leaderboard.entries.entry`.
"""
