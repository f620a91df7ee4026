"""The wire between host and guest: messages, transport, shared frames."""
