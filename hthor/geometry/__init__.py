"""Plane geometry and ray casting."""
