"""What a submitted agent consists of: its reference, files, arguments and manifest."""
