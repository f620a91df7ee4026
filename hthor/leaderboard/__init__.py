"""The leaderboard: runs as entries that anybody can check, a list of them with ranks, and a page.

An entry is one file. It holds the outcome of every trial and a hash of every trial's record, so that its numbers and
the ranks are computed from entries alone, and any trial that is drawn later can be replayed and compared. Begin with
`hthor.leaderboard.entries.entry`.
"""
