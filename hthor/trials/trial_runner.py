"""Running the trials of a session in one process: makes worlds, people and agents from their names."""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from msgspec import Struct

from hthor import code_identity, plugins
from hthor.errors import AgentError, HthorError
from hthor.guest.agent import agent_files
from hthor.guest.agent.manifest import File
from hthor.trials import human_team
from hthor.trials.participants import Participants, RecordedAgent
from hthor.trials.sources import Sources, load_pack
from hthor.trials.worlds import Objects, Worlds
from hthor.types import Mind, RobotSeat, RobotSpec, TrialSpec
from hthor.types.cameras import OWN

CODE_ROOT = "trial"

if TYPE_CHECKING:
    from hthor.episode import EpisodeLog, TrialWorld
    from hthor.guest import GuestPool
    from hthor.humans.model import HumanModel, State
    from hthor.trials.human_team import HumanTeam
    from hthor.trials.sessions import Session
    from hthor.world import World

    TrialLoop = Callable[[TrialSpec, TrialWorld, Mapping[str, HumanModel], Mapping[str, Mind]], EpisodeLog]
    """Drives a trial from its beginning to its end, such as `hthor.episode.play`."""


class PlayedTrial(Struct, frozen=True, kw_only=True):
    """A trial that is over.

    Attributes:
        spec: the trial. log: its course.
        opened: the agents' own files that they opened in it and that their manifests do not list, by seat.
    """

    spec: TrialSpec
    log: EpisodeLog
    opened: dict[str, tuple[File, ...]]


class TrialRunner:
    """Runs trials, and keeps worlds for later trials in the same house.

    Args:
        sources: the places of everything that does not ship with hthor.
        pool: keeps idle processes of submitted agents for later sessions; without it they end with their session.
        worlds: keeps the worlds; by default the runner's own.
        loop: drives each trial; by default `hthor.episode.play`.
    """

    def __init__(
        self,
        sources: Sources | None = None,
        pool: GuestPool | None = None,
        worlds: Worlds | None = None,
        loop: TrialLoop | None = None,
    ) -> None:
        self.sources, self._pool = sources or Sources(), pool
        self.worlds, self._loop = Worlds() if worlds is None else worlds, loop
        self._people: HumanTeam | None = None
        self._opened: dict[str, tuple[File, ...]] = {}  # files that agents opened beyond their manifests, by seat
        if self.sources.kind_path:
            plugins.load("task kind", self.sources.kind_path)

    def play(self, session: Session) -> Iterator[PlayedTrial]:
        """Run a session with new people and new agents, trial by trial."""
        with self.enter(session) as participants:
            for trial in session.trials:
                yield self.run(participants, trial)

    def enter(self, session: Session) -> Participants:
        """New people and new agents for a session."""
        first = session.trials[0]
        make_agent = functools.partial(self._make_agent, step_limit_s=first.step_limit_s or None)
        return Participants(self.make_people(first), first.robots, make_agent)

    def make_people(self, trial: TrialSpec, states: Mapping[str, State] | None = None) -> dict[str, HumanModel]:
        """The people of a trial, by seat, with what they remember of earlier trials of its session."""
        return self._people_of(trial).make_models(trial.seed, trial.humans, states)

    def world(self, trial: TrialSpec) -> World:
        """The world of a trial: an earlier trial's world if house, robots and sensors are the same."""
        task = trial.task
        _check_unchanged(self.sources.kind_path, trial.kind_sha256)
        objects = tuple((placed.id, placed.kind) for placed in task.objects)
        robots = tuple((seat.robot, seat.robot_sha256, seat.detector, seat.camera or OWN) for seat in trial.robots)
        places = self.sources.houses, self.sources.assets
        key = (task.house, task.house_sha256, len(trial.humans), robots, places)
        return self.worlds.get(key, objects, functools.partial(self._make_world, trial))

    def run(self, participants: Participants, trial: TrialSpec, world: TrialWorld | None = None) -> PlayedTrial:
        """Run the session's next trial. An agent that failed is in the log's faults, and stays in its seat.

        Args:
            world: used instead of the trial's world, for an observer.

        Raises:
            HthorError: when a file of the user's was changed since the run began, or an error is that of a plug-in.
        """
        self._check_files(participants)
        log = self._drive(world or self.world(trial), participants, trial)
        participants.finish_trial()
        self._check_files(participants)  # again: a trial in which a file changed halfway does not count
        return PlayedTrial(spec=trial, log=log, opened=self._opened_files(participants))

    def _drive(self, world: TrialWorld, participants: Participants, trial: TrialSpec) -> EpisodeLog:
        """Run one trial. An error in a plug-in of the user's is reported as theirs to fix."""
        from hthor.episode import play

        try:
            return (self._loop or play)(trial, world, participants.humans, participants.ready_agents())
        except (Exception, SystemExit) as error:
            if (own := plugins.user_error(error)) is None:
                raise
            raise own from error

    def _make_world(self, trial: TrialSpec, objects: Objects) -> World:
        from hthor.houses import HouseLibrary
        from hthor.world import World

        own = Path(self.sources.houses) if self.sources.houses else None
        pack = load_pack(self.sources.assets)
        if pack is not None and code_identity.pictures_sha256(pack.sha256) != trial.assets_sha256:
            raise HthorError(f"the pack '{self.sources.assets}' was rebuilt during its run; begin a new run.")
        return World(
            HouseLibrary(folder=own).load(trial.task.house),
            robots=tuple(self._robot(seat) for seat in trial.robots),
            objects=objects,
            detectors=tuple(seat.detector for seat in trial.robots),
            profile="fast" if pack is None else "nice",
            assets=pack or "",
            cameras=tuple(seat.camera or OWN for seat in trial.robots),
            people=len(trial.humans),
        )

    def _check_files(self, participants: Participants) -> None:
        """Check that the agents' files are those that the run began with."""
        for seat, agent in participants.agents.items():
            if isinstance(agent, RecordedAgent) and seat in self.sources.manifests:
                agent_files.check_unchanged(self.sources.manifests[seat], agent.mind.paths)
                agent_files.check_hashes(self._opened.get(seat, ()), agent.mind.paths)

    def _opened_files(self, participants: Participants) -> dict[str, tuple[File, ...]]:
        """The agents' own files that they opened in this trial and that their manifests do not list, by seat."""
        opened: dict[str, tuple[File, ...]] = {}
        for seat, agent in participants.agents.items():
            if isinstance(agent, RecordedAgent) and seat in self.sources.manifests:
                manifest, guest = self.sources.manifests[seat], agent.mind
                files = agent_files.unlisted_files(guest.take_opened(), manifest, guest.paths, guest.reference.path)
                if files:
                    opened[seat] = files
                    self._opened[seat] = tuple(sorted({*self._opened.get(seat, ()), *files}))
        return opened

    def _people_of(self, trial: TrialSpec) -> HumanTeam:
        """The populations of a trial's people; kept, as all trials of a run have the same."""
        if not self.sources.humans:
            return human_team.find_team(human_team.COMMA.join(human.model for human in trial.humans))
        if self._people is None:
            self._people = human_team.find_team(self.sources.humans)
        if [member.sha256 for member in self._people.members] != [human.sha256 for human in trial.humans]:
            raise HthorError(_changed_message(self.sources.humans))
        return self._people

    def _robot(self, seat: RobotSeat) -> RobotSpec:
        path = self.sources.robot_paths.get(seat.seat, "")
        if path:
            _check_unchanged(path, seat.robot_sha256)
        return plugins.load("robot", path or seat.robot)

    def _make_agent(self, seat: RobotSeat, step_limit_s: float | None) -> Mind:
        path = self.sources.agent_paths.get(seat.seat, "")
        if not path:
            return plugins.load("agent", seat.agent.name)()
        from hthor.guest import Guest, Unreachable

        make = functools.partial(Guest, path, config=self.sources.guests, pool=self._pool)
        guest = make() if step_limit_s is None else make(step_s=step_limit_s, bank_s=0.0)
        manifest = self.sources.manifests.get(seat.seat)
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
