"""What a session says about one person, parameter by parameter, and how that compares with a population."""
