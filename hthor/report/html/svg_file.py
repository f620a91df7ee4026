"""A figure of the page as a file of its own, with colours of light paper."""

import re

from hthor.report.html import matplotlib_svg

_HEAD = re.compile(r'<svg role="img" viewBox="0 0 ([\d.]+) ([\d.]+)" style="[^"]*">')
_FONT = "Helvetica, Arial, &quot;DejaVu Sans&quot;, sans-serif"


def svg_document(element: str) -> str:
    """The file's text.

    Args:
        element: as `hthor.report.html.matplotlib_svg` makes it.
    """
    found = _HEAD.match(element)
    assert found is not None
    wide, high = found.groups()
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" role="img" width="{wide}pt" height="{high}pt" '
        f'viewBox="0 0 {wide} {high}" font-family="{_FONT}">'
    )
    body = element[found.end() :]
    for colour, variable in matplotlib_svg.VARIABLES.items():
        body = body.replace(f"var(--{variable})", colour)
    return f'<?xml version="1.0" encoding="utf-8"?>\n{head}{body}\n'
