"""Triangle meshes: solids, sweeps and how to shape them."""
