"""When a session is over, everybody is given the page about themselves, and nobody else gets it."""

from __future__ import annotations

import threading
from pathlib import Path

import msgspec
import pytest
from live_client import ScriptedPerson, fetch
from test_live_run import make_run, no_looks, short

from hthor.calibration.person import person_files
from hthor.eval.runner.progress import Silent
from hthor.live import own_pages
from hthor.types import HUMAN

pytest.importorskip("starlette", reason="live sessions need an optional dependency: pip install 'hthor[live]'")

__all__ = ["no_looks", "short"]


def test_everybody_gets_their_own_page_at_an_address_that_only_they_know(
    tmp_path: Path, no_looks: None, short: None
) -> None:
    with (
        make_run(tmp_path / "run", agent=("frontier",)) as run,
        ScriptedPerson(run.server.address, run.server.desk_url.partition("#")[2], steers=False) as desk,
    ):
        playing = threading.Thread(target=lambda: run.play(lambda _: Silent()))
        playing.start()
        with ScriptedPerson(run.server.address, run.server.tokens[HUMAN]) as person:
            for count in (0, 1):
                person.wait_for("trial", trial=count)
                person.send({"type": "begin", "trial": count})
                person.wait_for("ended", trial=count)
                person.send({"type": "rate", "trial": count, "value": 6})
            assert person.wait_for("over", making=True)["page"] == ""
            over = person.wait_for("over", making=False)
            status, headers, page = fetch(run.server.address, over["page"])
            assert status == 200
            assert headers["Content-Security-Policy"] == own_pages.POLICY
            assert "Your session" in page
            assert "6 of 7" in page
            assert desk.wait_for("session_over")["pages"] == {HUMAN: "people/participant-0.html"}
            assert fetch(run.server.address, "/people/0.html")[0] == 404
            assert fetch(run.server.address, over["page"], Host="elsewhere.example")[0] == 404
        playing.join(60.0)
    assert (tmp_path / "run" / "people" / "participant-0.html").read_text(encoding="utf-8") == page
    ((profile, files),) = person_files.write(tmp_path / "run")
    assert [file.name for file in files] == ["participant-0.json", "participant-0.html"]
    assert all(row.measure.value is not None or row.measure.unknown for row in profile.parameters)
    assert "What this session does not tell of you" in files[1].read_text(encoding="utf-8")
    assert msgspec.json.decode(files[0].read_bytes())["schema"] == "hthor.person/1"
