"""From an emulator and published counts to a posterior over human parameters."""
