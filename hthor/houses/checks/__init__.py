"""Is a house sound? Structure, floor plan and furniture, judged by rules."""
