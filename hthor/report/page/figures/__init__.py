"""The report's figures, one per file, in the style of `hthor.report.html.matplotlib_svg`."""
