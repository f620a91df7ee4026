"""The parts of a submitted agent: its reference, files, arguments and manifest."""
