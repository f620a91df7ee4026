"""Admission, duplicates, ranks and the list of entries."""
