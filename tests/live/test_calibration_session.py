"""Simulated people at pages do the session that measures a person, and their own values are found."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest
from proxy_at_page import Follower, Turns, attend, in_batch

from hthor.calibration.from_logs import run as from_logs
from hthor.calibration.person import person_files, protocol
from hthor.calibration.person.measure import Measure
from hthor.calibration.person.profile import profiles
from hthor.eval.config.options import EvalOptions
from hthor.eval.runner.progress import Silent
from hthor.humans.population import population_file, resolve
from hthor.live.gltf import house_file
from hthor.live.run import LiveRun
from hthor.types import HUMAN

pytest.importorskip("starlette", reason="live sessions need an optional dependency: pip install 'hthor[live]'")

TRIALS = 9


@pytest.mark.nightly
def test_a_person_at_a_page_is_measured_as_they_are(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first participant of the population, whose own values are known; they turn as fast as the body can."""
    monkeypatch.setattr(house_file, "_make", lambda *_: b"")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))  # no session of this machine finds these houses
    played = in_batch(protocol.AGENT, 0, TRIALS, protocol.SUITE)
    options = protocol.prescribed(EvalOptions(humans=("live",), out=tmp_path / "run"))
    turns: list[Turns] = []
    with LiveRun(
        options,
        page=False,
        now=lambda: turns[0].now(),
        sleep=lambda seconds: turns[0].sleep(seconds),
        sections=person_files.sections,
    ) as run:
        turns.append(Turns(run.seats[HUMAN]))
        (session,) = run.scheduled.sessions

        def sit() -> None:
            for trial, (log, course) in zip(session.trials, played, strict=True):
                with Follower(run.server.address, run.server.tokens[HUMAN], trial.index, course) as person:
                    person.wait_for("trial", 600.0, trial=trial.index)
                    turns[0].restart()
                    attend(person, trial.index, log.ratings[HUMAN] or 4)
                    if trial.index == TRIALS - 1:
                        assert person.wait_for("over", 600.0, making=False)["page"]

        sitting = threading.Thread(target=sit)
        sitting.start()
        run.play(lambda _: Silent())
        sitting.join(600.0)
    (profile,) = profiles(tmp_path / "run")
    own = population_file.load_population(resolve.default_population()).draw_traits(0, 0)
    found: dict[str, Measure] = {row.measure.name: row.measure for row in profile.parameters}
    assert found["omega"].bound == "at least"
    assert own.omega >= found["omega"].low
    truths = {name: getattr(own, name) for name in ("v_pace", "t_on", "t_manip", "a0", "mu0")}
    missed = [
        name
        for name, truth in {**truths, "reading": own.t_notice + own.t_read}.items()
        if not found[name].low <= truth <= found[name].high
    ]
    assert len(missed) <= 2, missed  # each interval has nine of ten people, and this is one of them
    estimates, _ = from_logs.estimate_from_logs([tmp_path / "run"], "proxy", tmp_path / "calibration", lambda _: None)
    assert (estimates.people, estimates.trials) == (1, TRIALS)
    page = (tmp_path / "run" / "people" / "participant-0.html").read_text(encoding="utf-8")
    assert "You, beside others" in page
    assert "walking speed" in page
