"""The commands of `hthor`, one file or folder each; `hthor.cli` puts them together."""
