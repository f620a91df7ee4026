"""The Python examples of a page of the documentation."""


def only_code(page: str) -> str:
    """The page with everything but its Python blocks blanked, so that failures name the page's own lines."""
    inside, lines = False, []
    for line in page.splitlines():
        fence = line.startswith("```")
        lines.append(line if inside and not fence else "")
        inside = (line == "```python") if fence else inside
    return "\n".join(lines) + "\n"
