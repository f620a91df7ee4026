"""Kinds of task, one file each, which defines ``KIND``; a new file here is a new kind."""
