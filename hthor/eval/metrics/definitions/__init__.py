"""The definitions of all metrics; every file is found by its name and lists its records in ``METRICS``."""
