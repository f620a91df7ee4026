"""`hthor agent`, `hthor agents` and `hthor robots`."""
