"""Running many trials, keeping their logs, scoring and publishing them."""
