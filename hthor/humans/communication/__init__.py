"""Messages from robots: reading, interpretation, trust, the decision to accept."""
