"""The agent's side of the wire: what runs in the guest's process."""
