"""The page about driving a trial is true: its examples do what it shows."""

from __future__ import annotations

import doctest
from pathlib import Path

import pages


def test_the_examples_of_the_page_do_what_it_shows(root: Path) -> None:
    text = (root / "docs" / "episode.md").read_text(encoding="utf-8")
    test = doctest.DocTestParser().get_doctest(pages.only_code(text), {}, "episode.md", "docs/episode.md", 0)
    assert len(test.examples) >= 25
    failures: list[str] = []
    doctest.DocTestRunner(verbose=False).run(test, out=failures.append)
    assert not failures, "".join(failures)
