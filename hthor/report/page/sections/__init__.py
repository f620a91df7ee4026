"""The report's sections: functions of the findings that give parts of the page."""
