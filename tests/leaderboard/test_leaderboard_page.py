# ruff: noqa: F811  fixtures are imported, and named by tests
"""What stands in an entry reaches the page as text, whatever it holds and whoever wrote it."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import msgspec
import pytest
from board_fakes import code, kept, replayed, runs, verified, whole  # noqa: F401
from hypothesis import given
from hypothesis import strategies as st

from hthor.eval.statistics.intervals import NOTHING, Estimate
from hthor.leaderboard import board_check, publish
from hthor.leaderboard.entries import files
from hthor.leaderboard.entries.entry import Agent, Entry, Group, Harness
from hthor.leaderboard.entries.verification import Fresh, KeeperRecords
from hthor.leaderboard.page import page
from hthor.leaderboard.ranking import admission, listing
from hthor.leaderboard.ranking.board import Board, Struck
from hthor.report.html import markup

ROOT = Path(__file__).resolve().parents[2]
EVIL = "\"'><script>document.title='owned'</script><img src=x onerror=\"document.title='owned'\"><b id=owned>"
LINK = "javascript:document.title='owned'"


def hostile(value, name: str = "", within: str = ""):
    """The same record with every text in it replaced by one that is HTML, and every address by a script."""
    if isinstance(value, msgspec.Struct):
        kept_ = {"schema", "standing", "mode", "tier"}
        changed = {
            field: hostile(getattr(value, field), field) for field in value.__struct_fields__ if field not in kept_
        }
        return msgspec.structs.replace(value, **changed)
    if isinstance(value, dict):
        return {
            (EVIL if isinstance(key, str) else key) + str(i): hostile(v, name)
            for i, (key, v) in enumerate(value.items())
        }
    if isinstance(value, tuple):
        return tuple(hostile(one, name) for one in value)
    if isinstance(value, str):
        return LINK if name == "url" else EVIL
    return value


def boards(whole: Path) -> Board:
    """A board that shows everything that there is to show."""
    entries = [files.read_entry(path) for path in files.entry_paths(whole)]
    some = Estimate(mean=0.5, ci95=(0.4, 0.6), n=20, mde80=0.1)
    fresh = Fresh(
        suite="0" * 64, n=20, sr=some, twsr=some, claimed_sr=0.9, claimed_twsr=0.8, fell=True, detectable=0.1, why="x"
    )
    held = {one.id: verified(one, fresh=fresh) for one in entries}
    about = Agent(name="x", version="1", team="t", authors=("a",), url="https://example.org", licence="MIT")
    told = [msgspec.structs.replace(one, agent=about) if one.agent.name == "helper" else one for one in entries]
    for one in told:
        held[one.id] = verified(one, fresh=fresh)
    found = listing.make_board(told, KeeperRecords(verifications=held, refutations=()), admission.load_admission(whole))
    return msgspec.structs.replace(found, refuted=(Struck(id="i", name="n", why="w"),))


def test_every_text_of_a_board_is_escaped(whole: Path):
    text = page.render(hostile(boards(whole)))
    assert "&lt;script&gt;document.title" in text
    assert text.count("<script>") == 1, "the one that sorts"
    assert "<img" not in text
    assert "<b id" not in text
    assert not re.search(r"<a [^>]*href=\"(?!https?://)", text)
    tags = set(
        re.findall(r"<(/?[a-zA-Z!][a-zA-Z0-9]*)", re.sub(r"<(script|style)>.*?</\1>", "", text, flags=re.DOTALL))
    )
    assert {tag.strip("/") for tag in tags} <= {
        *("!doctype", "html", "head", "meta", "title", "link", "body", "main", "h1", "h2", "p", "section", "dl", "dt"),
        *("dd", "div", "table", "thead", "tbody", "tr", "th", "td", "span", "small", "b", "svg", "line", "circle", "g"),
        *("text", "details", "summary", "code", "ol", "ul", "li", "footer", "a"),
    }


def test_drawings_are_whole_and_sections_counted(whole: Path):
    """An element of a drawing that is not closed has the next ones within it, and a browser shows none of them."""
    everything = boards(whole)
    for found in (everything, msgspec.structs.replace(everything, refuted=())):
        text = page.render(found)
        drawings = [ElementTree.fromstring(one) for one in re.findall(r"<svg.*?</svg>", text, flags=re.DOTALL)]
        marks = [one for one in drawings if one.find("g") is not None]
        assert len(marks) == len(found.sections[0].rows)
        assert all(one.find("g/circle") is not None and one.find("line/line") is None for one in marks)
        numbers = [int(one) for one in re.findall(r"<h2><span>(\d+)</span>", text)]
        assert numbers == list(range(1, len(numbers) + 1))


def test_an_entry_links_the_page_that_shows_one_of_its_trials_if_there_is_one(whole: Path, tmp_path: Path):
    board = tmp_path / "board"
    shutil.copytree(whole, board)
    ids = [path.stem for path in files.entry_paths(board)]
    assert b"watch a trial" not in publish.board_files(board)[files.PAGE]
    shown = board / "watch" / ids[0] / "index.html"
    shown.parent.mkdir(parents=True)
    shown.touch()
    page_ = publish.board_files(board)[files.PAGE].decode()
    assert page_.count("watch a trial") == 1
    assert f'<a href="watch/{ids[0]}/index.html">watch a trial</a>' in page_


def test_labels_that_are_not_the_same_in_all_entries_do_not_stop_the_page(whole: Path):
    found = boards(whole)
    (section,) = found.sections
    odd = {"kind": {"<b>x": Group(sr=NOTHING, twsr=NOTHING)}}
    rows = (msgspec.structs.replace(section.rows[0], splits=odd), *section.rows[1:])
    text = page.render(msgspec.structs.replace(found, sections=(msgspec.structs.replace(section, rows=rows),)))
    assert "&lt;b&gt;x" in text


@pytest.mark.skipif(shutil.which("chromium") is None, reason="Chromium is not installed")
def test_a_browser_runs_nothing_that_an_entry_brings(whole: Path, tmp_path: Path):
    for name, found in (("true", boards(whole)), ("hostile", hostile(boards(whole)))):
        (tmp_path / f"{name}.html").write_text(page.render(found))
        options = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--enable-logging=stderr"]
        options += [f"--user-data-dir={tmp_path / 'browser'}", "--dump-dom", f"file://{tmp_path / name}.html"]
        done = subprocess.run(["chromium", *options], capture_output=True, text=True, timeout=300, check=True)
        assert ":CONSOLE" not in done.stderr, "nothing that the policy had to stop"
        assert "<title>hthor leaderboard</title>" in done.stdout
        assert 'tabindex="0"' in done.stdout, "our own script has run"
        assert "<img" not in done.stdout
        assert 'id="owned"' not in done.stdout


@pytest.mark.skipif(shutil.which("chromium") is None, reason="Chromium is not installed")
def test_the_policy_stops_what_would_slip_through(tmp_path: Path, whole: Path):
    text = page.render(boards(whole)).replace("</main>", "<script>document.title='owned'</script></main>")
    (tmp_path / "page.html").write_text(text)
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run"]
    options += [f"--user-data-dir={tmp_path / 'browser'}", "--dump-dom", f"file://{tmp_path / 'page.html'}"]
    done = subprocess.run(["chromium", *options], capture_output=True, text=True, timeout=300, check=True)
    assert "<title>hthor leaderboard</title>" in done.stdout


def test_tags_are_made_in_one_place():
    """No other module of the leaderboard writes one, so nothing that it forgets to escape can be one."""
    for path in sorted((ROOT / "hthor" / "leaderboard").glob("*.py")):
        if path.name != "markup.py":
            code_ = re.sub(r'SORT = """.*?"""', "", path.read_text(), flags=re.DOTALL)
            assert not re.search(r"[\"'][^\"'\n]*</?[a-z!][a-z0-9]*[ />]", code_), path
            assert "Markup(" not in code_, path


@given(st.text(), st.text())
def test_text_is_text_wherever_it_stands(inside: str, attribute: str):
    made = markup.tag("p", inside, markup.tag("b", "x"), title=attribute).html
    assert made.count("<") == made.count(">") == 4
    assert "<script" not in made
    assert markup.link(attribute if attribute.startswith("http") else LINK, inside).html.count("<a") <= 1


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("harness", Harness(version="<script>alert(1)</script>", commit="", dirty=False)),
        ("agent", Agent(name="x\n")),
        ("agent", Agent(name="x", url=LINK)),
        ("agent", Agent(name="x", url='https://a.b/"><script>')),
    ],
)
def test_the_schema_takes_no_such_values(whole: Path, tmp_path: Path, field: str, value: object):
    entry: Entry = files.read_entry(next(path for path in files.entry_paths(whole) if path.name.startswith("helper")))
    path = tmp_path / f"{entry.id}.json"
    files.write_document(path, msgspec.structs.replace(entry, **{field: value}))
    assert [one.field.partition(".")[0] for one in board_check.form_problems(path)] == [field]
