"""One person's own page: their trials, the messages that they got, and what the robots did for them."""
