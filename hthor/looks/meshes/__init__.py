"""Triangle meshes: solids, sweeps, and functions that shape them."""
