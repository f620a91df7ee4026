"""Where a person looks next."""
