"""The report's figures, one a file, in the look of `hthor.report.html.matplotlib_svg`."""
