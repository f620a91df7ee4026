"""What all videos share: the file, and words drawn into frames."""
