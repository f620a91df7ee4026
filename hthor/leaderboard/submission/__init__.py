"""What is handed in: an agent's folder, unpacked and checked."""
