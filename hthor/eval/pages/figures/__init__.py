"""The report's figures, one a file, in the look of `hthor.eval.pages.ink`; they know nothing of the page."""
