"""Messages from robots: reading, interpretation, time saved, the decision to accept, trust."""
