"""Pictures of what every seat saw at some moments of a logged trial, which is played again with cameras.

Taking pictures changes nothing, which is checked: the record of the repeated trial must equal the logged record.
"""

from collections.abc import Callable, Collection, Sequence
from pathlib import Path
from typing import Any

import msgspec

from hthor import activity
from hthor.errors import RunError
from hthor.eval.config.sessions import Session
from hthor.eval.records import trial_record
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.records.trial_record import TrialRecord
from hthor.eval.replay import session_history
from hthor.eval.replay.session_history import RunFiles
from hthor.eval.runner import trial_runner
from hthor.guest import AgentInputs, GuestConfig
from hthor.types import TaskSpec
from hthor.types.events import Event

SIZE = (400, 300)
_FINER = 2
"""Pictures are drawn this many times larger and then averaged, which makes edges smooth."""

Views = dict[int, dict[str, Any]]
"""Pictures (H, W, 3) uint8 by tick and seat."""


class CameraFrames:
    """A world that also keeps what its seats see at some ticks, for drawing later."""

    def __init__(self, world: Any, ticks: Collection[int], profile: str) -> None:
        self._world, self._ticks, self._profile = world, frozenset(ticks), profile
        self._kept: dict[int, dict[str, Callable[[], Any]]] = {}

    def __getattr__(self, name: str) -> Any:
        return getattr(self._world, name)

    def reset(self, task: TaskSpec, seed: int = 0) -> None:
        self._kept.clear()
        self._world.reset(task, seed=seed)
        self._look()

    def advance(self) -> tuple[Event, ...]:
        events: tuple[Event, ...] = self._world.advance()
        self._look()
        return events

    def views(self) -> Views:
        """Draw and return the pictures."""
        return {tick: {seat: _averaged(draw()) for seat, draw in kept.items()} for tick, kept in self._kept.items()}

    def _look(self) -> None:
        world = self._world
        if world.tick in self._ticks:
            size = (_FINER * SIZE[0], _FINER * SIZE[1])
            self._kept[world.tick] = {seat: world.frame(seat, size, self._profile) for seat in world.seats}


def render_frames(
    folder: Path,
    wanted: TrialRecord,
    ticks: Collection[int],
    *,
    profile: str = "fast",
    agents: Sequence[str] = (),
    humans: str = "",
    given: AgentInputs | None = None,
) -> Views:
    """Play a trial again and return pictures of what its seats saw.

    Args:
        folder: of the run. wanted: the trial. ticks: when to take pictures.
        profile: how pictures are drawn, fast or nice.
        agents: files of the run's agents that are not built in. humans: the human model, if the log's name does not
        find it. given: arguments and files that the agents were given.

    Raises:
        RunError: if trials before it are missing, another version of hthor played them, or the trial ends differently.
        HthorError: if a file that was not given is needed.
    """
    spec, run = wanted.spec, RunFolder(folder)
    session = Session(number=spec.session, trials=session_history.session_before(run, wanted))
    guests = GuestConfig(hidden=(str(folder.resolve()),), inputs=given or AgentInputs())
    files = RunFiles(agents=tuple(agents), humans=humans)
    stage = trial_runner.TrialRunner(session_history.replay_sources(run, spec, files, guests))
    with stage.enter(session) as company:
        for number, trial in enumerate(session.trials, 1):
            activity.say(f"playing {folder.name} again, trial {number} of {len(session.trials)}")
            world = CameraFrames(stage.world(trial), ticks if trial == spec else (), profile)
            done = stage.run(company, trial, world).record
        if _course(done) != _course(wanted):
            raise RunError(
                f"{folder}: trial {wanted.key} did not repeat as it was logged, so its views would show another "
                "trial. The agent is not deterministic, or the machine is different; 'hthor replay' draws the trial "
                "from its log alone."
            )
        activity.say(f"drawing what was seen in {folder.name}")
        return world.views()


def _averaged(picture: Any) -> Any:
    """The picture in its final size."""
    wide, high = SIZE
    parts = picture.reshape(high, _FINER, wide, _FINER, 3).astype("float32")
    return parts.mean(axis=(1, 3)).round().astype("uint8")


def _course(done: TrialRecord) -> bytes:
    """Everything that happened, without the texts of faults, which agents write."""
    plain = tuple(msgspec.structs.replace(fault, detail="") for fault in done.faults)
    return trial_record.encode(msgspec.structs.replace(done, faults=plain))
