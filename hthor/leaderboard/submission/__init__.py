"""Submitted agents: their folders, unpacked and checked."""
