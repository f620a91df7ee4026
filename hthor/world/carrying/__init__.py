"""Two bodies that carry one trunk."""
