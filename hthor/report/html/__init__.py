"""HTML, styles and SVG for self-contained pages."""
