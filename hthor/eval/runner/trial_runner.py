"""Who plays in a trial: worlds, people and robots' minds made from their names."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
from msgspec import Struct

from hthor import code_identity, gc_freeze, plugins
from hthor.errors import AgentError, HthorError
from hthor.eval.runner.agent_recorder import RecordedAgent
from hthor.guest.agent import agent_files
from hthor.guest.agent.manifest import File, Manifest
from hthor.guest.host.config import GuestConfig
from hthor.types import Mind, RobotSeat, TrialSpec
from hthor.types.cameras import OWN

CODE_ROOT = "trial"

if TYPE_CHECKING:
    from hthor.episode import EpisodeLog
    from hthor.eval.config.sessions import Session
    from hthor.eval.records.trial_record import TrialRecord
    from hthor.guest import GuestPool
    from hthor.humans.model import HumanModel
    from hthor.humans.population.resolve import ParticipantSource
    from hthor.looks.pack import Pack
    from hthor.world import World


class Sources(Struct, frozen=True, kw_only=True):
    """Where that lies which is not ours: files of minds and of bodies by their seats, what these minds consist of,
    the file of a kind of task, the name of the furniture pack that pictures show, the folder of the suite's own houses,
    the word that finds the people again (empty: the name in the trial does), and how submitted agents are isolated.
    """

    minds: dict[str, str] = {}
    manifests: dict[str, Manifest] = {}
    bodies: dict[str, str] = {}
    kind: str = ""
    assets: str = ""
    houses: str = ""
    people: str = ""
    guests: GuestConfig = GuestConfig()


def load_pack(assets: str) -> Pack | None:
    """The furniture pack of this name, None for our own furniture.

    Raises:
        UnknownName: when there is none.
    """
    if not assets:
        return None
    from hthor.looks import pack

    return pack.load(assets)


class TrialRunner:
    """Makes worlds and companies, and keeps worlds for the next trial in the same house.

    Args:
        sources: where that lies which is not ours.
        pool: idle processes of submitted agents to use and to leave; without one they end with their session.
    """

    def __init__(self, sources: Sources | None = None, pool: GuestPool | None = None) -> None:
        self._sources, self._pool = sources or Sources(), pool
        self._worlds: dict[object, World] = {}
        self._people: ParticipantSource | None = None
        self._seen: dict[str, tuple[File, ...]] = {}  # what agents opened and their manifests do not list, by seat
        gc_freeze.unfreeze_after(self)
        if self._sources.kind:
            plugins.load("task kind", self._sources.kind)

    def enter(self, session: Session) -> Participants:
        """The person and the robots of a session, new to one another."""
        first = session.trials[0]
        mind = functools.partial(self._mind, step_limit_s=first.step_limit_s or None)
        return Participants(self._persons(first).make_model(first.seed, first.participant), first.robots, mind)

    def world(self, trial: TrialSpec) -> World:
        """The world of a trial: that of an earlier one where house, objects, robots and senses are the same."""
        task = trial.task
        _unchanged(self._sources.kind, trial.kind_sha256)
        bodies = tuple(seat.robot for seat in trial.robots)
        objects = tuple((placed.id, placed.kind) for placed in task.objects)
        detectors = tuple(seat.detector for seat in trial.robots)
        cameras = tuple(seat.camera or OWN for seat in trial.robots)
        key = (task.house, task.house_sha256, bodies, detectors, cameras, objects)
        if key not in self._worlds:
            from hthor.houses import HouseLibrary
            from hthor.world import World

            specs = tuple(self._body(seat) for seat in trial.robots)
            own = Path(self._sources.houses) if self._sources.houses else None
            pack = load_pack(self._sources.assets)
            if pack is not None and code_identity.pictures_sha256(pack.sha256) != trial.assets_sha256:
                raise HthorError(
                    f"the pack '{self._sources.assets}' was built anew while its run was going on; begin a new run."
                )
            self._worlds[key] = World(
                HouseLibrary(folder=own).load(task.house),
                robots=specs,
                objects=objects,
                detectors=detectors,
                profile="fast" if pack is None else "nice",
                assets=pack or "",
                cameras=cameras,
            )
            gc_freeze.freeze_existing()
        return self._worlds[key]

    def play(self, company: Participants, trial: TrialSpec, world: Any = None) -> TrialRecord:
        """The company's next trial. A mind that failed is let go, and what is left of it laid down.

        Args:
            world: stands for the trial's world, for somebody who looks on.
        """
        from hthor.eval.records import trial_record
        from hthor.eval.runner import fault_report, redact

        self._examine(company)
        log = _run_trial(world or self.world(trial), company, trial)
        company.rest()
        self._examine(company)  # before its record is written: what was played halfway with another file is no trial
        opened = self._opened(company)
        if not log.faults:
            return msgspec.structs.replace(trial_record.make_record(trial, log), files=opened or msgspec.UNSET)
        files = self._sources.minds.values()
        told = (msgspec.structs.replace(one, detail=redact.redact(one.detail, files)) for one in log.faults)
        done = trial_record.make_record(trial, msgspec.structs.replace(log, faults=tuple(told)))
        done = msgspec.structs.replace(done, files=opened or msgspec.UNSET)
        fault_report.leave(fault_report.describe_faults(done.key, trial, done.faults, company.minds))
        for seat in dict.fromkeys(fault.seat for fault in log.faults):
            company.dismiss(seat)
        return done

    def _examine(self, company: Participants) -> None:
        """See that the agents' files are the ones that the run began with."""
        for seat, mind in company.minds.items():
            if isinstance(mind, RecordedAgent) and seat in self._sources.manifests:
                agent_files.check_unchanged(self._sources.manifests[seat], mind.mind.paths)
                agent_files.check_hashes(self._seen.get(seat, ()), mind.mind.paths)

    def _opened(self, company: Participants) -> dict[str, tuple[File, ...]]:
        """What agents opened of their own in the trial that was played, and no manifest lists."""
        found: dict[str, tuple[File, ...]] = {}
        for seat, mind in company.minds.items():
            if isinstance(mind, RecordedAgent) and seat in self._sources.manifests:
                known, grounds = self._sources.manifests[seat], mind.mind.paths
                if files := agent_files.unlisted_files(
                    mind.mind.take_opened(), known, grounds, mind.mind.reference.path
                ):
                    found[seat] = files
                    self._seen[seat] = tuple(sorted({*self._seen.get(seat, ()), *files}))
        return found

    def _persons(self, trial: TrialSpec) -> ParticipantSource:
        """Whom the person of a trial is drawn from; kept, as all trials of a run have the same."""
        from hthor.humans.population import resolve

        if not self._sources.people:
            return resolve.resolve_humans(trial.human)
        if self._people is None:
            self._people = resolve.resolve_humans(self._sources.people)
        if self._people.sha256 != trial.human_sha256:
            raise HthorError(_changed_message(self._sources.people))
        return self._people

    def _body(self, seat: RobotSeat) -> Any:
        path = self._sources.bodies.get(seat.seat, "")
        if path:
            _unchanged(path, seat.robot_sha256)
        return plugins.load("robot", path or seat.robot)

    def _mind(self, seat: RobotSeat, step_limit_s: float | None) -> Mind:
        path = self._sources.minds.get(seat.seat, "")
        if not path:
            mind: Mind = plugins.load("agent", seat.agent.name)()
            return mind
        from hthor.guest import Guest, Unreachable

        make = functools.partial(Guest, path, config=self._sources.guests, pool=self._pool)
        guest = make() if step_limit_s is None else make(step_s=step_limit_s, bank_s=0.0)
        known = self._sources.manifests.get(seat.seat)
        if known is not None:
            agent_files.check_unchanged(known, guest.paths)
        try:
            changed = guest.load().sha256 != seat.agent.sha256
        except Unreachable:  # a server that is gone for a while costs its trials, not the run
            return RecordedAgent(guest)
        if changed and known is not None and known.claimed:
            guest.close()
            raise AgentError(_changed_message(path))
        return RecordedAgent(guest)


def _unchanged(path: str, sha256: str) -> None:
    """See that a user's file is the one that the run began with."""
    if sha256 and plugins.sha256(path) != sha256:
        raise HthorError(_changed_message(path))


def _changed_message(path: str) -> str:
    return (
        f"{path} was changed while its run was going on. Change it back and repeat the command to finish this run, "
        "or evaluate the new version in a run of its own."
    )


class Participants:
    """One session's person and minds. Use as a context manager: guests are processes and must be let go."""

    def __init__(self, human: HumanModel, seats: Sequence[RobotSeat], make: Callable[[RobotSeat], Mind]) -> None:
        self.human: Any = human
        self._seats = tuple(seats)
        self._make = make
        self._minds: dict[str, Mind] = {}

    def __enter__(self) -> Participants:
        return self

    def __exit__(self, *_: object) -> None:
        for seat in tuple(self._minds):
            self.dismiss(seat)

    def robots(self) -> Mapping[str, Mind]:
        """A mind for each robot's seat: the one of the trial before, unless it was dismissed."""
        for robot in self._seats:
            if robot.seat not in self._minds:
                self._minds[robot.seat] = self._make(robot)
        return dict(self._minds)

    @property
    def minds(self) -> Mapping[str, Mind]:
        """The minds of the trial that was played, by seat."""
        return self._minds

    def rest(self) -> None:
        """The trial is over: whoever clears up for the next may do so now."""
        for mind in self._minds.values():
            if (finish := getattr(mind, "finish", None)) is not None:
                finish()

    def dismiss(self, seat: str) -> None:
        """Let a mind go; the next trial gets a fresh one."""
        mind: Any = self._minds.pop(seat)
        if hasattr(mind, "close"):
            mind.close()


def make_runner(sources: Sources | None = None) -> Callable[[Session], Iterator[TrialRecord]]:
    """What a worker does with each session: play its trials in order. Called in the worker; imports what is heavy."""
    from hthor.guest import GuestPool

    stage = TrialRunner(sources, GuestPool())

    def perform(session: Session) -> Iterator[TrialRecord]:
        with stage.enter(session) as company:
            for trial in session.trials:
                yield stage.play(company, trial)

    return perform


def _run_trial(world: Any, company: Participants, trial: TrialSpec) -> EpisodeLog:
    """One trial; a failure in a plug-in of the user's is theirs to mend, and told as such."""
    from hthor.episode import run_episode

    try:
        return run_episode(trial, world, company.human, company.robots())
    except (Exception, SystemExit) as error:
        if (own := plugins.user_error(error)) is None:
            raise
        raise own from error
