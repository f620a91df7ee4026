"""The report and the case study as pages."""
