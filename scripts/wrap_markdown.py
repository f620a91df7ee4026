"""Wraps the prose of Markdown files at 120 columns: `wrap_markdown.py FILE...`; `make fmt` calls it.

Only paragraphs and list items with a longer line are wrapped. Code, tables, headings, quotes, HTML and comments stay as
they are, and nothing but white space changes.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

WIDTH = 120
_WORD = re.compile(r"(?:`[^`]*`|\[[^\]]*\]\([^)]*\)|\S)+")
"""A word; code and links are not broken."""
_ITEM = re.compile(r"\s*(?:[-*+]|\d+[.)])\s+")
_NO_PROSE = re.compile(r"\s*(?:#|\||<|>|!\[|\[[^\]]+\]:|:::|---|===)|.*  $|\s*$")
_MARKUP = re.compile(r"[-+*#>|=]+$|\d+[.)]$")
"""What would begin a list, a heading, a quote or a table at the beginning of a line."""


def wrapped(text: str) -> str:
    """The text with its long paragraphs wrapped."""
    new = "\n".join(line for prose, block in _blocks(text.split("\n")) for line in (_fitted(block) if prose else block))
    assert new.split() == text.split(), "only white space may change"
    return new


def _blocks(lines: Iterable[str]) -> Iterator[tuple[bool, list[str]]]:
    """Paragraphs and list items, with True; every other line alone, with False."""
    block: list[str] = []
    fenced = comment = False
    for line in lines:
        fence = line.lstrip().startswith("```")
        comment = comment or "<!--" in line
        alone = fenced or fence or comment or _NO_PROSE.match(line) is not None
        if alone or _ITEM.match(line):
            if block:
                yield True, block
            block = []
        if alone:
            yield False, [line]
        else:
            block.append(line)
        fenced ^= fence
        comment = comment and "-->" not in line
    if block:
        yield True, block


def _fitted(block: list[str]) -> list[str]:
    if max(map(len, block)) <= WIDTH:
        return block
    head = re.match(r"\s*(?:(?:[-*+]|\d+[.)])\s+)?", block[0])
    assert head is not None
    first = head[0]
    indent = re.match(r"\s*", block[1])[0] if len(block) > 1 else " " * len(first)  # type: ignore[index]
    lines = [first]
    for word in _words(" ".join([block[0][len(first) :], *(line.strip() for line in block[1:])])):
        if len(lines[-1]) + 1 + len(word) <= WIDTH:
            lines[-1] += word if lines == [first] else " " + word
        else:
            lines.append(indent + word)
    return lines


def _words(text: str) -> list[str]:
    """What a line may begin with: words, each with the markup that follows it."""
    words: list[str] = []
    for word in _WORD.findall(text):
        if words and _MARKUP.match(word):
            words[-1] += " " + word
        else:
            words.append(word)
    return words


def main(paths: Iterable[str]) -> None:
    """Wrap each file in place."""
    for path in map(Path, paths):
        text = path.read_text(encoding="utf-8")
        new = wrapped(text)
        if new != text:
            path.write_text(new, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
