"""The trial of the README's film as the page of `hthor watch` shows it: `python -m benchmarks.watch_film FILE.webp`.

The film has eight seconds. Time runs faster than in the house, and slower while a message is read
(`benchmarks.readme_film.shown_ticks`).
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from benchmarks import page_browser, readme_film
from hthor.eval.records import scored_trial
from hthor.eval.records.scored_trial import ScoredTrial
from hthor.eval.runner import session_runner
from hthor.trials import TrialRunner
from hthor.trials.sessions import Session
from hthor.watch import page, record_trial
from hthor.watch.record_trial import RecordedTrial
from hthor.watch.recorder import RecordedWorld

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
_TURN = 0.32
"""[rad] By how much the camera turns round the house in the film."""


def write_film(path: Path, session: Session) -> None:
    """Write the film of the last trial of a session as an animated WebP that begins again for ever."""
    record, trial = play(session)
    readme_film.write_frames(path, list(frames(record, trial)))


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
    ticks = readme_film.shown_ticks(record)
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
                kept = cv2.resize(picture, readme_film.SIZE, interpolation=cv2.INTER_AREA)
                last = tick
            yield kept


def main() -> None:
    """Write the film of the README's trial to the file that is named."""
    from benchmarks import pictures

    (task,) = pictures.FILMS.values()
    write_film(Path(sys.argv[1]), pictures.session_until(task))


if __name__ == "__main__":
    main()
