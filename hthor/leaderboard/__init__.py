"""The leaderboard: runs as entries that anybody can check, a list of them with ranks, and a page; plays only to verify.

An entry is one file. It carries what became of every trial and a hash of every trial's record, so that its numbers and
the ranks are worked out from entries alone, and any trial that is drawn later can be played again and compared.
"""
