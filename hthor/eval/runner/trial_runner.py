"""Running the trials of a session in one process: makes worlds, people and agents from their names."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
from msgspec import Struct

from hthor import code_identity, gc_freeze, plugins
from hthor.errors import AgentError, HthorError
from hthor.eval.runner import fault_report
from hthor.eval.runner.fault_report import RecordedAgent
from hthor.eval.runner.messages import TrialOutcome
from hthor.guest.agent import agent_files
from hthor.guest.agent.manifest import File, Manifest
from hthor.guest.host.info import GuestConfig
from hthor.types import Mind, RobotSeat, RobotSpec, TrialSpec
from hthor.types.cameras import OWN

CODE_ROOT = "trial"

if TYPE_CHECKING:
    from hthor.episode import EpisodeLog, TrialWorld
    from hthor.eval.config.human_team import HumanTeam
    from hthor.eval.config.sessions import Session
    from hthor.guest import GuestPool
    from hthor.humans.model import HumanModel
    from hthor.looks.pack import Pack
    from hthor.world import World


def load_pack(assets: str) -> Pack | None:
    """The furniture pack of this name, None for our own furniture; raises UnknownName where no pack has it."""
    if not assets:
        return None
    from hthor.looks import pack

    return pack.load(assets)


class Sources(Struct, frozen=True, kw_only=True):
    """The places of those parts of a trial that do not ship with hthor.

    Attributes:
        agent_paths: the submitted agents, by seat; ``manifests`` lists their files, by seat.
        robot_paths: the files of the user's own robots, by seat.
        kind_path: the file of a user's own task kind.
        assets: the name of the furniture pack that pictures show, empty for our own furniture.
        houses: the folder of the suite's own houses.
        humans: the word that finds the people again; empty where the names in the trial find them.
        guests: how submitted agents are isolated, and which arguments and files they get.
    """

    agent_paths: dict[str, str] = {}
    manifests: dict[str, Manifest] = {}
    robot_paths: dict[str, str] = {}
    kind_path: str = ""
    assets: str = ""
    houses: str = ""
    humans: str = ""
    guests: GuestConfig = GuestConfig()


class TrialRunner:
    """Runs trials, and keeps worlds for the next trial in the same house.

    Args:
        sources: the places of everything that does not ship with hthor.
        pool: keeps idle processes of submitted agents for later sessions; without it they end with their session.
    """

    def __init__(self, sources: Sources | None = None, pool: GuestPool | None = None) -> None:
        self._sources, self._pool = sources or Sources(), pool
        self._worlds: dict[object, World] = {}
        self._people: HumanTeam | None = None
        self._opened: dict[str, tuple[File, ...]] = {}  # files that agents opened beyond their manifests, by seat
        gc_freeze.unfreeze_after(self)
        if self._sources.kind_path:
            plugins.load("task kind", self._sources.kind_path)

    def enter(self, session: Session) -> Participants:
        """New people and new agents for a session."""
        first = session.trials[0]
        make_agent = functools.partial(self._make_agent, step_limit_s=first.step_limit_s or None)
        humans = self._people_of(first).make_models(first.seed, first.humans)
        return Participants(humans, first.robots, make_agent)

    def world(self, trial: TrialSpec) -> World:
        """The world of a trial: an earlier trial's world if house, objects, robots and sensors are the same."""
        task = trial.task
        _check_unchanged(self._sources.kind_path, trial.kind_sha256)
        robots = tuple(seat.robot for seat in trial.robots)
        objects = tuple((placed.id, placed.kind) for placed in task.objects)
        detectors = tuple(seat.detector for seat in trial.robots)
        cameras = tuple(seat.camera or OWN for seat in trial.robots)
        people = len(trial.humans)
        key = (task.house, task.house_sha256, people, robots, detectors, cameras, objects)
        if key not in self._worlds:
            from hthor.houses import HouseLibrary
            from hthor.world import World

            specs = tuple(self._robot(seat) for seat in trial.robots)
            own = Path(self._sources.houses) if self._sources.houses else None
            pack = load_pack(self._sources.assets)
            if pack is not None and code_identity.pictures_sha256(pack.sha256) != trial.assets_sha256:
                raise HthorError(f"the pack '{self._sources.assets}' was rebuilt during its run; begin a new run.")
            self._worlds[key] = World(
                HouseLibrary(folder=own).load(task.house),
                robots=specs,
                objects=objects,
                detectors=detectors,
                profile="fast" if pack is None else "nice",
                assets=pack or "",
                cameras=cameras,
                people=people,
            )
            gc_freeze.freeze_existing()
        return self._worlds[key]

    def run(self, participants: Participants, trial: TrialSpec, world: TrialWorld | None = None) -> TrialOutcome:
        """Run the session's next trial. An agent that failed is ended and reported.

        Args:
            world: used instead of the trial's world, for an observer.
        """
        from hthor.eval.records import trial_record

        self._check_files(participants)
        log = _run_trial(world or self.world(trial), participants, trial)
        participants.finish_trial()
        self._check_files(participants)  # again: a trial in which a file changed halfway does not count
        opened = self._opened_files(participants) or msgspec.UNSET
        paths = self._sources.agent_paths.values()
        faults = (msgspec.structs.replace(one, detail=fault_report.redact(one.detail, paths)) for one in log.faults)
        record = trial_record.make_record(trial, msgspec.structs.replace(log, faults=tuple(faults)))
        record = msgspec.structs.replace(record, files=opened)
        if not log.faults:
            return TrialOutcome(record=record)
        report = fault_report.describe_faults(record.key, trial, record.faults, participants.agents)
        for seat in dict.fromkeys(fault.seat for fault in log.faults):
            participants.dismiss(seat)
        return TrialOutcome(record=record, fault_report=report)

    def _check_files(self, participants: Participants) -> None:
        """Check that the agents' files are those that the run began with."""
        for seat, agent in participants.agents.items():
            if isinstance(agent, RecordedAgent) and seat in self._sources.manifests:
                agent_files.check_unchanged(self._sources.manifests[seat], agent.mind.paths)
                agent_files.check_hashes(self._opened.get(seat, ()), agent.mind.paths)

    def _opened_files(self, participants: Participants) -> dict[str, tuple[File, ...]]:
        """The agents' own files that they opened in this trial and that their manifests do not list, by seat."""
        opened: dict[str, tuple[File, ...]] = {}
        for seat, agent in participants.agents.items():
            if isinstance(agent, RecordedAgent) and seat in self._sources.manifests:
                manifest, guest = self._sources.manifests[seat], agent.mind
                files = agent_files.unlisted_files(guest.take_opened(), manifest, guest.paths, guest.reference.path)
                if files:
                    opened[seat] = files
                    self._opened[seat] = tuple(sorted({*self._opened.get(seat, ()), *files}))
        return opened

    def _people_of(self, trial: TrialSpec) -> HumanTeam:
        """The populations of a trial's people; kept, as all trials of a run have the same."""
        from hthor.eval.config import human_team

        if not self._sources.humans:
            return human_team.find_team(human_team.COMMA.join(human.model for human in trial.humans))
        if self._people is None:
            self._people = human_team.find_team(self._sources.humans)
        if [member.sha256 for member in self._people.members] != [human.sha256 for human in trial.humans]:
            raise HthorError(_changed_message(self._sources.humans))
        return self._people

    def _robot(self, seat: RobotSeat) -> RobotSpec:
        path = self._sources.robot_paths.get(seat.seat, "")
        if path:
            _check_unchanged(path, seat.robot_sha256)
        return plugins.load("robot", path or seat.robot)

    def _make_agent(self, seat: RobotSeat, step_limit_s: float | None) -> Mind:
        path = self._sources.agent_paths.get(seat.seat, "")
        if not path:
            return plugins.load("agent", seat.agent.name)()
        from hthor.guest import Guest, Unreachable

        make = functools.partial(Guest, path, config=self._sources.guests, pool=self._pool)
        guest = make() if step_limit_s is None else make(step_s=step_limit_s, bank_s=0.0)
        manifest = self._sources.manifests.get(seat.seat)
        if manifest is not None:
            agent_files.check_unchanged(manifest, guest.paths)
        try:
            changed = guest.load().sha256 != seat.agent.sha256
        except Unreachable:  # a server that is gone for a while costs its trials, not the run
            return RecordedAgent(guest)
        if changed and manifest is not None and manifest.claimed:
            guest.close()
            raise AgentError(_changed_message(path))
        return RecordedAgent(guest)


def _check_unchanged(path: str, sha256: str) -> None:
    """Check that a user's file is the one that the run began with."""
    if sha256 and plugins.sha256(path) != sha256:
        raise HthorError(_changed_message(path))


def _changed_message(path: str) -> str:
    return (
        f"{path} was changed while its run was going on. Change it back and repeat the command to finish this run, "
        "or evaluate the new version in a run of its own."
    )


class Participants:
    """The people and the agents of one session. A context manager: submitted agents are processes, which it ends.

    Args:
        humans: the human models by seat; they remember earlier trials of the session.
        seats: the robots.
        make_agent: makes the agent of a seat.
    """

    def __init__(
        self,
        humans: Mapping[str, HumanModel],
        seats: Sequence[RobotSeat],
        make_agent: Callable[[RobotSeat], Mind],
    ) -> None:
        self.humans = dict(humans)
        self._seats = tuple(seats)
        self._make_agent = make_agent
        self.agents: dict[str, Mind] = {}  # of the last trial, by seat

    def __enter__(self) -> Participants:
        return self

    def __exit__(self, *_: object) -> None:
        for seat in tuple(self.agents):
            self.dismiss(seat)

    def ready_agents(self) -> Mapping[str, Mind]:
        """An agent for each robot, by seat: the agent of the trial before, or a new agent if that one was dismissed."""
        for robot in self._seats:
            if robot.seat not in self.agents:
                self.agents[robot.seat] = self._make_agent(robot)
        return dict(self.agents)

    def finish_trial(self) -> None:
        """The trial is over: agents that clean up for the next trial may do so now."""
        for agent in self.agents.values():
            if (finish := getattr(agent, "finish", None)) is not None:
                finish()

    def dismiss(self, seat: str) -> None:
        """End an agent; the next trial gets a new one."""
        agent: Any = self.agents.pop(seat)
        if hasattr(agent, "close"):
            agent.close()


def make_runner(sources: Sources | None = None) -> Callable[[Session], Iterator[TrialOutcome]]:
    """A function that runs a session's trials in order. Called in the worker, as it imports large libraries."""
    from hthor.guest import GuestPool

    runner = TrialRunner(sources, GuestPool())

    def run_session(session: Session) -> Iterator[TrialOutcome]:
        with runner.enter(session) as participants:
            for trial in session.trials:
                yield runner.run(participants, trial)

    return run_session


def _run_trial(world: TrialWorld, participants: Participants, trial: TrialSpec) -> EpisodeLog:
    """Run one trial. An error in a plug-in of the user's is reported as theirs to fix."""
    from hthor.episode import play

    try:
        return play(trial, world, participants.humans, participants.ready_agents())
    except (Exception, SystemExit) as error:
        if (own := plugins.user_error(error)) is None:
            raise
        raise own from error
