"""The report's sections: each function takes the findings and returns parts of the page."""
