"""What a submitted agent consists of: its files, arguments and manifest."""
