"""Pages of the documentation site that do not lie in docs/: a hook of mkdocs, named in mkdocs.yml.

It adds a page of reference for each public module, the tutorial's notebook with what its cells print, and the project's
own pages from the root of the repository. Links are written as GitHub needs them; here they lead to the site's pages.
"""

from __future__ import annotations

import os
import posixpath
import re
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File, Files

ROOT = Path(__file__).resolve().parents[1]
MODULES = {
    "Records": ["hthor.types"],
    "Agents": ["hthor.agents"],
    "Navigation": ["hthor.navigation"],
    "The simulator": ["hthor.world"],
    "Trials": ["hthor.episode"],
    "Human models": ["hthor.humans.model"],
    "Task kinds": ["hthor.tasks.kind"],
    "Houses": ["hthor.houses"],
    "The catalog": ["hthor.catalog"],
    "Messages": ["hthor.comms"],
    "Logs": ["hthor.eval.records.trial_record", "hthor.eval.records.trial_log", "hthor.types.events"],
    "Results": ["hthor.eval.results.result_file"],
    "Metrics": ["hthor.eval.metrics.metric"],
    "Rules": ["hthor.rules"],
    "Geometry": ["hthor.geometry"],
    "Random numbers": ["hthor.seeds"],
    "Errors": ["hthor.errors"],
}
"""The public modules, by the titles of their pages of reference."""
PROJECT = {
    "CONTRIBUTING.md": "contributing.md",
    "SECURITY.md": "security.md",
    "CODE_OF_CONDUCT.md": "conduct.md",
    "CHANGELOG.md": "changelog.md",
    "leaderboard/README.md": "leaderboard-board.md",
}
"""Pages from outside docs/, by where they lie in the repository."""
NOTEBOOK = "tutorial.ipynb"
_LINK = re.compile(r"\[(?P<text>[^\]]*)\]\((?P<path>[^)\s#:]+)(?P<part>#[^)\s]*)?\)")
_FILE = re.compile(r"(?:[\w/]+/)?[\w-]+\.(?:md|ipynb)")
"""The text of a link that names a file, which is a page's title in the site."""


def on_config(config: Any) -> Any:
    """Put the pages of reference where the navigation has `reference/`."""
    config["nav"] = _with_reference(config["nav"])
    return config


def on_files(files: Files, config: Any) -> Files:
    """Add the pages that are made here."""
    for title, modules in MODULES.items():
        content = "\n".join([f"# {title}\n", *(f"::: {module}\n" for module in modules)])
        files.append(File.generated(config, _page(modules), content=content))
    for source, page in PROJECT.items():
        files.append(File.generated(config, page, content=(ROOT / source).read_text(encoding="utf-8")))
    notebook = files.get_file_from_path(NOTEBOOK)
    assert notebook is not None
    text, pictures = executed(ROOT / "docs" / NOTEBOOK)
    files.append(File.generated(config, "tutorial.md", content=text))
    for name, data in pictures.items():
        files.append(File.generated(config, name, content=data))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Files) -> str:
    """Links lead to the repository's files; in the site they lead to the pages made of these."""
    made = {page: source for source, page in PROJECT.items()}
    source = made.get(page.file.src_uri, f"docs/{page.file.src_uri}")

    def moved(link: re.Match[str]) -> str:
        path = posixpath.normpath(posixpath.join(posixpath.dirname(source), link["path"]))
        if not (ROOT / path).is_file():
            return link[0]  # mkdocs says that it is broken
        place = posixpath.relpath(_in_site(path, files, config), posixpath.dirname(page.file.src_uri) or ".")
        text = _title(ROOT / path) if _FILE.fullmatch(link["text"]) and place.endswith(".md") else link["text"]
        return f"[{text}]({place}{link['part'] or ''})"

    markdown = re.sub(r"^(<!--.*-->)\n(?=\S)", r"\1\n\n", markdown, flags=re.MULTILINE)  # else a table after it is text
    return "".join(
        part if part.startswith("```") else _LINK.sub(moved, part)
        for part in re.split(r"(^```.*?^```)", markdown, flags=re.MULTILINE | re.DOTALL)
    )


def _title(path: Path) -> str:
    """The first heading of a page or a notebook."""
    found = re.search(r"^\s*\"?# (.*?)(?:\\n.*)?$", path.read_text(encoding="utf-8"), re.MULTILINE)
    assert found is not None, path
    return found[1]


def _in_site(path: str, files: Files, config: Any) -> str:
    """Where a file of the repository is in the site; one that has no page there is added as it is."""
    if path in PROJECT:
        return PROJECT[path]
    if path == f"docs/{NOTEBOOK}":
        return "tutorial.md"
    if path.startswith("docs/"):
        return path.removeprefix("docs/")
    place = f"repository/{path}"
    if files.get_file_from_path(place) is None:
        files.append(File.generated(config, place, content=(ROOT / path).read_bytes()))
    return place


def executed(notebook: Path) -> tuple[str, dict[str, bytes]]:
    """A notebook as Markdown after a run of all its cells in an empty folder, and its pictures by their names.

    Raises:
        nbclient.exceptions.CellExecutionError: when a cell fails.
    """
    import nbformat
    from jupyter_client import KernelManager
    from nbclient import NotebookClient
    from nbconvert import MarkdownExporter
    from nbconvert.filters import strip_ansi

    os.environ["COLUMNS"] = "100"  # tables of commands are as wide as the page
    os.environ["PATH"] = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    cells = nbformat.read(notebook, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        kernel = KernelManager(kernel_name="python3", transport="ipc", connection_file=f"{folder}/.kernel.json")
        try:
            place = {"metadata": {"path": folder}}
            NotebookClient(cells, km=kernel, timeout=600, coalesce_streams=True, resources=place).execute()
        finally:
            kernel.shutdown_kernel(now=True)
    for output in (output for cell in cells.cells for output in cell.get("outputs", ())):
        if "text" in output:
            output["text"] = strip_ansi(output["text"])
    names = {"output_files_dir": f"{notebook.stem}_files", "unique_key": notebook.stem}
    text, made = MarkdownExporter().from_notebook_node(cells, resources=names)
    return text, made["outputs"]


def _with_reference(nav: list[Any]) -> list[Any]:
    return [_entry(entry) for entry in nav]


def _entry(entry: Any) -> Any:
    if not isinstance(entry, dict):
        return entry
    ((title, below),) = entry.items()
    if below == "reference/":
        return {title: [{name: _page(modules)} for name, modules in MODULES.items()]}
    return {title: _with_reference(below) if isinstance(below, list) else below}


def _page(modules: Sequence[str]) -> str:
    return f"reference/{modules[0].removeprefix('hthor.').replace('.', '-')}.md"
