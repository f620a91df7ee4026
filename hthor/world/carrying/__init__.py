"""Several bodies that carry one thing, such as a trunk, together."""
