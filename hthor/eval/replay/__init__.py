"""Logged trials played again, byte for byte."""
