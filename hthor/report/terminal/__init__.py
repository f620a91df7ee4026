"""Results and comparisons as terminal tables."""
