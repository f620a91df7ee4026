"""The files of a run: trial records, the log, isolation and platform."""
