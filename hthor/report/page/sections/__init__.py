"""The report's sections, one a file, in the order in which they stand; each knows its tables and figures alone."""
