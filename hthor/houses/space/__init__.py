"""Where bodies fit, what they see and how far they walk in a house at rest."""
