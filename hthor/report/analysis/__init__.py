"""What the report says, worked out from runs: no HTML here."""
