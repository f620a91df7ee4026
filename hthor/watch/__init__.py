"""A logged trial in three dimensions, on a page that needs no server: `hthor watch`."""
