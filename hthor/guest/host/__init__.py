"""hthor's side of the wire: starting a guest, asking it, judging its answers."""
