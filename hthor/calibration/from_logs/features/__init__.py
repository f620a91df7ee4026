"""What one trial's log says of walking, manipulation and messages, as features."""
