"""What newcomers read and what serves them agree with the project: pages, templates, hooks, notebook, pictures."""

from __future__ import annotations

import ast
import functools
import importlib.util
import json
import re
import shlex
import subprocess
import sys
import tomllib
from pathlib import Path
from types import ModuleType
from typing import Any
from xml.etree import ElementTree

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

import hthor

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
GITHUB = sorted((ROOT / ".github").rglob("*.yml"))
FORMS = sorted(path for path in (ROOT / ".github" / "ISSUE_TEMPLATE").glob("*.yml") if path.stem != "config")
DOCS = sorted((ROOT / "docs").glob("*.md"))
TOP = [ROOT / f"{name}.md" for name in ("README", "CONTRIBUTING", "SECURITY", "CODE_OF_CONDUCT", "CHANGELOG")]
PAGES = [*TOP, *DOCS, ROOT / "leaderboard" / "README.md"]
NOTEBOOK = ROOT / "docs" / "tutorial.ipynb"
CONTRIBUTING = (ROOT / "CONTRIBUTING.md").read_text()
CHANGES = ("Added", "Changed", "Deprecated", "Removed", "Fixed", "Security")
WIDTH = 120


def _name(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def _constant(name: str) -> Any:
    """A table of the site's hook, which is read and not imported: it needs the extra `docs`."""
    tree = ast.parse((ROOT / "scripts" / "site_pages.py").read_text())
    assigned = {
        target.id: node.value
        for node in tree.body
        if isinstance(node, ast.Assign)
        for target in node.targets
        if isinstance(target, ast.Name)
    }
    return ast.literal_eval(assigned[name])


# ---- templates, hooks, citation


@pytest.mark.parametrize("path", [*GITHUB, ROOT / ".pre-commit-config.yaml", ROOT / "CITATION.cff"], ids=_name)
def test_yaml_can_be_read(path: Path):
    assert isinstance(yaml.safe_load(path.read_text()), dict)


@pytest.mark.parametrize("path", FORMS, ids=lambda path: path.stem)
def test_a_form_of_an_issue_asks_something_and_asks_it_once(path: Path):
    form = yaml.safe_load(path.read_text())
    assert form["name"]
    assert form["description"]
    asked = [part for part in form["body"] if part["type"] != "markdown"]
    assert {part["type"] for part in asked} <= {"textarea", "input", "dropdown", "checkboxes"}
    ids = [part["id"] for part in asked]
    assert len(set(ids)) == len(ids)
    assert all(part["attributes"]["label"] for part in asked)
    assert any(part.get("validations", {}).get("required") for part in asked)


def test_the_citation_is_of_this_version_and_has_what_the_format_requires():
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    assert cited["cff-version"] == "1.2.0"
    assert {"message", "title", "authors"} <= cited.keys()
    assert cited["version"] == PROJECT["project"]["version"] == hthor.__version__
    assert cited["license"] == PROJECT["project"]["license"]
    assert all({"type", "title", "authors"} <= reference.keys() for reference in cited["references"])
    assert any("2406.06498" in str(reference) for reference in cited["references"])


def test_hooks_before_a_commit_are_the_environments_own_tools():
    clientlib = pytest.importorskip(
        "pre_commit.clientlib", reason="pre-commit is not installed: make .venv/.installed-dev"
    )
    config = clientlib.load_config(ROOT / ".pre-commit-config.yaml")
    hooks = [hook for repository in config["repos"] for hook in repository["hooks"]]
    assert {repository["repo"] for repository in config["repos"]} == {"local"}, "versions are those of constraints.txt"
    assert {hook["entry"].split()[0] for hook in hooks} == {
        f".venv/bin/{tool}" for tool in ("ruff", "mypy", "lint-imports")
    }
    assert {hook["language"] for hook in hooks} <= {"system", "unsupported"}


@pytest.mark.parametrize("extra", ["dev", "docs"])
def test_what_an_extra_asks_for_is_pinned(extra: str):
    names = {re.split(r"[\[<>=!~ ]", line)[0].lower() for line in PROJECT["project"]["optional-dependencies"][extra]}
    pinned = {
        line.partition("==")[0].lower().replace("_", "-") for line in (ROOT / "constraints.txt").read_text().split()
    }
    assert names <= pinned


def test_no_file_of_the_project_is_ignored():
    """Linters skip what git ignores, and `git add` leaves new files beside it out."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--ignored", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    if listed.returncode:
        pytest.skip("this copy of the project is no git repository")
    assert listed.stdout.split() == []


# ---- commands and places that pages name


def _targets() -> set[str]:
    return set(re.findall(r"^([\w./-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))


@pytest.mark.parametrize("path", PAGES, ids=_name)
def test_what_is_to_be_made_can_be_made(path: Path):
    text = path.read_text()
    asked = set(re.findall(r"^make ([\w-]+)", text, re.MULTILINE)) | set(re.findall(r"`make ([\w./-]+)", text))
    assert asked <= _targets()


def test_contributing_names_every_target_that_people_type():
    typed = _targets() - {"python", "install", "clean"}
    assert {f"make {name}" for name in typed if not name.startswith(".")} <= set(re.findall(r"make \w+", CONTRIBUTING))


def test_modules_and_files_that_contributing_names_are_there():
    modules = re.findall(r"`python -m ([\w.]+)", CONTRIBUTING)
    scripts = re.findall(r"`python (scripts/\w+\.py)", CONTRIBUTING)
    assert modules
    assert scripts
    assert [name for name in scripts if not (ROOT / name).is_file()] == []
    assert [name for name in modules if importlib.util.find_spec(name) is None] == []
    places = re.findall(
        r"`((?:hthor|tests|docs|examples|benchmarks|scripts|leaderboard|\.github)/[\w./]*)`", CONTRIBUTING
    )
    assert len(places) > 5
    gone = [place for place in places if not (ROOT / place.partition("NAME")[0]).exists()]
    assert gone == []


def test_the_quick_check_leaves_out_only_what_was_measured_to_be_long():
    makefile = (ROOT / "Makefile").read_text()
    check, test = (re.search(rf"^{name}:(.*(?:\n\t.*)+)", makefile, re.MULTILINE) for name in ("check", "test"))
    assert check is not None
    assert test is not None
    assert '-m "not nightly" --quick' in check[1]
    assert '-m "not nightly"' in test[1]
    assert "--quick" not in test[1]
    assert check[1].split()[0] == test[1].split()[0] == "lint"


# ---- pages


@pytest.mark.parametrize("path", [*PAGES, NOTEBOOK], ids=_name)
def test_links_to_files_lead_to_files(path: Path):
    for link, part in _links(path.read_text() if path != NOTEBOOK else "\n".join(_cells("markdown"))):
        target = path.parent / link
        assert target.exists(), link
        if part and target.suffix == ".md":
            assert part[1:] in _anchors(target.read_text()), link + part


@pytest.mark.parametrize("path", [path for path in PAGES if path.name != "README.md" or path.parent != ROOT], ids=_name)
def test_pages_of_the_site_link_to_pages_that_the_site_has(path: Path):
    has = {*DOCS, *(ROOT / source for source in _constant("PROJECT"))}
    links = [link for link, _ in _links(path.read_text()) if link.endswith(".md")]
    assert [link for link in links if (path.parent / link).resolve() not in has] == []


def _links(text: str) -> list[tuple[str, str]]:
    """Links to files, and to what part of them."""
    text = re.sub(r"^ *```.*?^ *```", "", text, flags=re.MULTILINE | re.DOTALL)
    return [link for link in re.findall(r"\]\(([^)\s#]+)(#[^)\s]+)?\)", text) if "://" not in link[0]]


def _anchors(text: str) -> set[str]:
    """Of the headings, as GitHub makes them, and those that are written out."""
    headings = re.findall(r"^#+ (.*)$", text, re.MULTILINE)
    slugs = {
        re.sub(r"[^\w\- ]", "", heading.replace("`", "")).strip().lower().replace(" ", "-") for heading in headings
    }
    return slugs | set(re.findall(r"<a (?:id|name)=\"([\w-]+)\"", text))


@pytest.mark.parametrize("path", [path for path in PAGES if path.name != "CHANGELOG.md"], ids=_name)
def test_prose_has_lines_that_fit(path: Path):
    text = re.sub(r"^ *```.*?^ *```", "", path.read_text(), flags=re.MULTILINE | re.DOTALL)
    prose = [
        line for line in text.splitlines() if not line.lstrip().startswith(("|", "![", "<")) and line[:4] != "    "
    ]
    assert [line for line in prose if len(line) > WIDTH] == [], "make fmt wraps them"


@functools.cache
def _script(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, ROOT / "scripts" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def _wrapped(text: str) -> str:
    wrapped: str = _script("wrap_markdown").wrapped(text)
    return wrapped


WORDS = st.lists(
    st.sampled_from(["robot", "`a piece of code`", "[a link](docs/x.md)", "2.", "-", "#", "x" * 30]), max_size=60
)


@given(st.lists(st.tuples(st.sampled_from(["", "- ", "12. ", "  * "]), WORDS), max_size=4))
def test_wrapping_changes_white_space_alone_and_is_done_after_once(parts: list[tuple[str, list[str]]]):
    text = "\n\n".join(head + " ".join(["start", *words]) for head, words in parts) + "\n"
    wrapped = _wrapped(text)
    assert wrapped.split() == text.split()
    assert _wrapped(wrapped) == wrapped
    starts = [line.split()[0] for line in wrapped.splitlines() if line.strip()]
    assert [word for word in starts if word in {"2.", "#"}] == [], "no list or heading where there was none"


def test_wrapping_leaves_code_tables_and_comments_alone():
    long = "word " * 40
    text = f"```\n{long}\n```\n\n| {long} |\n\n<!--\n{long}\n-->\n\n# {long}\n"
    assert _wrapped(text) == text
    assert max(map(len, _wrapped(long.strip()).splitlines())) <= WIDTH


def test_every_page_has_a_place_in_the_site():
    nav = (ROOT / "mkdocs.yml").read_text().partition("\nnav:\n")[2].partition("\n\n")[0]
    shown = set(re.findall(r"([\w-]+\.md)", nav))
    made = set(_constant("PROJECT").values())
    assert shown == {path.name for path in DOCS} | made | {"tutorial.md"}
    assert all((ROOT / source).is_file() for source in _constant("PROJECT"))


@pytest.mark.parametrize("module", [module for modules in _constant("MODULES").values() for module in modules])
def test_modules_of_the_reference_are_there_and_have_a_docstring(module: str):
    spec = importlib.util.find_spec(module)
    assert spec is not None
    assert spec.origin is not None
    assert ast.get_docstring(ast.parse(Path(spec.origin).read_text()))


def test_the_guide_lists_every_page():
    listed = set(re.findall(r"^\| \[([\w.-]+)\]\(\1\) \|", (ROOT / "docs" / "index.md").read_text(), re.MULTILINE))
    assert listed == {path.name for path in DOCS} - {"index.md"} | {NOTEBOOK.name}


# ---- README


README = (ROOT / "README.md").read_text()
FILM = re.compile(r"^!\[.{20,}\]\((docs/images/\w+\.webp)\)$", re.MULTILINE)
ANIMATION, FRAME = b"ANIM", b"ANMF"


def test_the_readme_is_short_and_begins_with_a_film():
    assert len(README.split()) <= 650
    (film,) = FILM.finditer(README)
    assert README[: film.start()].count("\n") < 6
    data = (ROOT / film[1]).read_bytes()
    assert len(data) <= 2_000_000
    parts = _parts_of_webp(data)
    lasts = [int.from_bytes(part[12:15], "little") for name, part in parts if name == FRAME]
    assert sum(lasts) == 8000, "milliseconds"
    assert len(lasts) > 50
    (animation,) = (part for name, part in parts if name == ANIMATION)
    assert animation[4:6] == b"\0\0", "it begins anew for ever"


def _parts_of_webp(data: bytes) -> list[tuple[bytes, bytes]]:
    """The chunks of a WebP file: names and contents."""
    assert data[:4] == b"RIFF"
    assert data[8:12] == b"WEBP"
    parts, at = [], 12
    while at < len(data):
        size = int.from_bytes(data[at + 4 : at + 8], "little")
        parts.append((data[at : at + 4], data[at + 8 : at + 8 + size]))
        at += 8 + size + size % 2
    return parts


def test_the_readmes_rows_are_those_of_the_board():
    board = json.loads((ROOT / "leaderboard" / "leaderboard.json").read_text())
    (section,) = (one for one in board["sections"] if one["suite"]["name"] == "standard")
    table = README.partition("## Leaderboard\n")[2].partition("## ")[0]
    assert f"{section['trials']} tasks" in table
    rows = [line.strip("| ").split(" | ") for line in table.splitlines() if line.startswith("| ")][1:]
    assert len(rows) == len(section["rows"])
    entries = {entry["name"]: entry for entry in section["rows"]}
    for name, success, weighted in rows:
        rate, low, high = map(float, re.findall(r"[\d.]+", success))
        assert [rate, low, high] == pytest.approx(
            [100 * part for part in (entries[name]["sr"]["mean"], *entries[name]["sr"]["ci95"])], abs=0.051
        )
        assert float(weighted) == pytest.approx(100 * entries[name]["twsr"]["mean"], abs=0.051)


def test_the_readme_cites_what_the_citation_file_cites():
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text())
    software, paper = (
        dict(re.findall(r"(\w+)=\{+(.*?)\}+,?$", entry, re.MULTILINE))
        for entry in README.partition("```bibtex\n")[2].partition("```")[0].split("\n\n")
    )
    assert software == {
        "author": cited["authors"][0]["name"],
        "title": cited["title"],
        "note": f"Version {cited['version']}",
    }
    (reference,) = cited["references"]
    first, others = reference["authors"]
    assert paper == {
        "author": f"{first['family-names']}, {first['given-names']} {others['name']}",
        "title": reference["title"],
        "booktitle": reference["conference"]["name"],
        "year": str(reference["year"]),
        "note": reference["identifiers"][0]["value"],
    }


def test_the_readmes_agent_has_ten_lines_and_is_the_example():
    (code,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    assert len([line for line in code.splitlines() if line.strip()]) <= 10
    assert (ROOT / "examples" / "wanderer.py").read_text().endswith(code)


def test_the_readmes_commands_begin_with_the_clone_and_name_the_agents_file():
    commands = _script("readme").commands(README)
    assert [command.partition(" ")[0] for command in commands[:3]] == ["git", "make", "make"]
    assert (
        _script("readme").filled(commands[0], ROOT) == f"git clone --quiet {shlex.quote(str(ROOT))} hthor && cd hthor"
    )
    (written,) = (number for number, command in enumerate(commands) if command.startswith("cat > my_agent.py <<"))
    used = [number for number, command in enumerate(commands) if " my_agent.py" in command and number != written]
    assert used
    assert min(used) > written


@pytest.mark.parametrize("page", ["README.md", "docs/index.md"])
def test_a_pages_placeholders_are_all_filled(page: str, tmp_path: Path):
    for name in ("frontier", "oracle"):
        folder = tmp_path / "runs" / f"{name}-smoke-0"
        folder.mkdir(parents=True)
        (folder / "run.json").write_text("{}")
    script = _script("readme")
    commands = script.commands((ROOT / page).read_text())
    assert len(commands) > 5
    typed = [script.filled(line, tmp_path) for line in commands if "SNIPPET" not in line]
    assert [line for line in typed if re.search(r"(?<![\w/.-])[A-Z]{3,}(?![\w/.-])", line)] == []


# ---- notebook and diagram


def _cells(kind: str) -> list[str]:
    cells = json.loads(NOTEBOOK.read_text())["cells"]
    return ["".join(cell["source"]) for cell in cells if cell["cell_type"] == kind]


def test_the_notebook_is_stored_without_outputs():
    notebook = json.loads(NOTEBOOK.read_text())
    assert notebook["nbformat"] == 4
    code = [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert code
    assert [cell["outputs"] for cell in code if cell["outputs"]] == []
    assert {cell["execution_count"] for cell in code} == {None}


def test_cells_of_the_notebook_compile():
    for cell in _cells("code"):
        magic, _, rest = cell.partition("\n")
        if magic == "%%bash":
            subprocess.run(["bash", "-n"], input=rest, text=True, check=True)
        else:
            compile(rest if magic.startswith("%%writefile") else cell, NOTEBOOK.name, "exec")


def test_the_notebooks_agent_keeps_to_the_contract_of_an_agent(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (code,) = (cell.partition("\n")[2] for cell in _cells("code") if cell.startswith("%%writefile"))
    (tmp_path / "tutorial_agent.py").write_text(code)
    monkeypatch.syspath_prepend(str(tmp_path))
    agent = importlib.import_module("tutorial_agent").Agent
    sys.modules.pop("tutorial_agent")
    assert callable(agent.begin)
    assert callable(agent.act)


def test_the_diagram_has_words_for_those_who_cannot_see_it_and_needs_no_network():
    path = ROOT / "docs" / "images" / "trial.svg"
    picture = ElementTree.parse(path).getroot()
    named = {child.tag.partition("}")[2]: (child.text or "").strip() for child in picture}
    assert named["title"]
    assert named["desc"]
    assert set(picture.get("aria-labelledby", "").split()) == {child.get("id") for child in picture[:2]}
    assert re.findall(r"https?://(?!www\.w3\.org/2000/svg)", path.read_text()) == []


# ---- changelog


def test_changes_stand_below_headings_that_say_of_what_sort_they_are():
    lines = (ROOT / "CHANGELOG.md").read_text().splitlines()
    versions = [line for line in lines if line.startswith("## ")]
    assert versions[0] == "## [Unreleased]"
    assert all(re.fullmatch(r"## \[\d+\.\d+\.\d+\] - \d{4}-\d\d-\d\d", line) for line in versions[1:])
    heading = ""
    for line in lines:
        if line.startswith("#"):
            heading = line
        if line.startswith("- "):
            assert heading.removeprefix("### ") in CHANGES, line
    sections = "\n".join(lines).split("\n## ")[1:]
    for section in sections:
        sorts = re.findall(r"^### (.*)$", section, re.MULTILINE)
        assert len(set(sorts)) == len(sorts)
        assert set(sorts) <= set(CHANGES)
