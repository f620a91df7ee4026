"""The film of the README: a trial in eight seconds, as the page of `hthor watch` shows it in a browser.

Time runs faster than in the house, and slower while a message is read.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from PIL import Image

from benchmarks import page_browser
from hthor import rules
from hthor.eval.records import scored_trial
from hthor.eval.records.scored_trial import ScoredTrial
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.runner import session_runner
from hthor.trials import TrialRunner
from hthor.trials.sessions import Session
from hthor.types.events import Accepted, Event, Opened, Picked, Placed, Sent
from hthor.watch import page, record_trial
from hthor.watch.record_trial import RecordedTrial
from hthor.watch.recorder import RecordedWorld

LENGTH_S, FRAME_S = 8.0, 0.05
"""Length of the film and of one frame [s]."""
SIZE = (800, 478)
"""Width and height of the film [pixels]."""
_QUALITY = 80
_SHOWS = (Sent, Accepted, Picked, Opened, Placed)
_READ_S, _CALM_S, _HOLD_S = 1.1, 0.5, 1.1
"""Seconds of the film for a message to be read, after any other event, and at the end."""
_READ_OF_S, _CALM_OF_S = 1.4, 1.0
"""Seconds of the trial that pass meanwhile."""
_WINDOW = (1120, 669)
"""Width and height of the browser's window [pixels]; its pictures are made smaller."""
_PATIENCE_MS = 120_000
_SHOW = """({seconds, turn}) => {
  watch.renderer.setAnimationLoop(null);
  watch.seek(seconds);
  watch.free.yaw = Math.PI / 2 + turn;
  watch.eyesAt = -1e9;
  watch.frame(performance.now());
  watch.frame(performance.now());
}"""
_TURN = 0.2
"""[rad] By how much the camera turns round the house in the film."""


def write_film(path: Path, session: Session) -> None:
    """Write the film of the last trial of a session as an animated WebP that begins again for ever."""
    record, trial = play(session)
    _write_frames(path, list(frames(record, trial)))


def play(session: Session) -> tuple[ScoredTrial, RecordedTrial]:
    """Play a session, and record its last trial."""
    runner = TrialRunner()
    with runner.enter(session) as company:
        for spec in session.trials[:-1]:
            session_runner.run_trial(runner, company, spec)
        spec = session.trials[-1]
        world = RecordedWorld(runner.world(spec))
        record = scored_trial.score(session_runner.run_trial(runner, company, spec, world).record)
    return record, record_trial.finish("film", record, world)


def frames(record: ScoredTrial, trial: RecordedTrial) -> Iterator[Any]:
    """The frames, (H, W, 3) uint8 in the order of colours of OpenCV."""
    ticks = shown_ticks(record)
    with tempfile.TemporaryDirectory() as folder, page_browser.browser() as browser:
        file = page.write_page(Path(folder), page.make_page(trial))
        shown = browser.new_page(viewport=dict(zip(("width", "height"), _WINDOW, strict=True)))
        shown.set_default_timeout(_PATIENCE_MS)
        shown.goto(f"file://{file}")
        shown.wait_for_selector("#bottom")
        shown.keyboard.press("l")  # without the list of events
        shown.keyboard.press("r")
        last, kept = -1, None
        for k, tick in enumerate(ticks):
            share = k / len(ticks) - 0.5
            if tick != last:
                shown.evaluate(_SHOW, {"seconds": tick / 10, "turn": _TURN * share})
                data = np.frombuffer(shown.screenshot(timeout=_PATIENCE_MS), np.uint8)
                picture = cv2.imdecode(data, cv2.IMREAD_COLOR)
                assert picture is not None
                kept = cv2.resize(picture, SIZE, interpolation=cv2.INTER_AREA)
                last = tick
            yield kept


def _write_frames(path: Path, shown: Sequence[Any]) -> None:
    """Write frames of `FRAME_S` each, (H, W, 3) uint8 in the order of colours of OpenCV, as an animated WebP."""
    frames, lasts = _joined(shown)
    first, *others = (Image.fromarray(cv2.cvtColor(frame, cv2.COLOR_BGR2RGB)) for frame in frames)
    first.save(
        path,
        save_all=True,
        append_images=others,
        duration=lasts,
        loop=0,
        quality=_QUALITY,
        method=6,
        minimize_size=True,
    )


def _joined(frames: Sequence[Any]) -> tuple[list[Any], list[int]]:
    """The frames without those that equal the one before, and how long each is shown [ms]."""
    kept: list[Any] = []
    lasts: list[int] = []
    for frame in frames:
        if kept and np.array_equal(kept[-1], frame):
            lasts[-1] += round(1000 * FRAME_S)
        else:
            kept.append(frame)
            lasts.append(round(1000 * FRAME_S))
    return kept, lasts


def shown_ticks(record: TrialRecord) -> list[int]:
    """The tick of each frame: slow after a message, a little slow after other events, evenly fast between them."""
    whole, some = record.ticks * rules.TICK_S, _milestones(record)
    slow: list[tuple[float, float, float]] = []
    for event, (begin, after) in zip(some, pairwise([*(one.tick * rules.TICK_S for one in some), whole]), strict=True):
        lasts, of = (_READ_S, _READ_OF_S) if isinstance(event, Sent) else (_CALM_S, _CALM_OF_S)
        span = min(of, after - begin)
        slow.append((begin, begin + span, lasts * span / of))
    left = LENGTH_S - _HOLD_S - sum(lasts for _, _, lasts in slow)
    pace = left / (whole - sum(end - begin for begin, end, _ in slow))
    film, trial = [0.0], [0.0]
    for begin, end, lasts in slow:
        film += [film[-1] + (begin - trial[-1]) * pace]
        film += [film[-1] + lasts]
        trial += [begin, end]
    film += [film[-1] + (whole - trial[-1]) * pace]
    at = np.arange(round(LENGTH_S / FRAME_S)) * FRAME_S
    return [int(tick) for tick in np.round(np.interp(at, film, [*trial, whole]) / rules.TICK_S)]


def _milestones(record: TrialRecord) -> list[Event]:
    """The events that the film is about: messages, answers, and what is done with the target and its destination."""
    return [event for event in record.log.events if isinstance(event, _SHOWS)]
