"""How robots and the person talk."""
