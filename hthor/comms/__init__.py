"""How robots and the person talk; knows nothing of worlds, minds or pictures."""
