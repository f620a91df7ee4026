"""The validation report: what is known of how far a human model may be trusted; it plays nothing and fits nothing."""
