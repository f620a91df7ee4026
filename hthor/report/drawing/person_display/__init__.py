"""What was on a person's display in a logged trial: pictures of panel and map, and when they were shown."""
