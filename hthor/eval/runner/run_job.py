"""One run as a job: its configuration, robots, people, tasks, and the paths of everything that a worker needs."""

import functools
from pathlib import Path

from msgspec import Struct

from hthor.eval.config.human_team import HumanTeam
from hthor.eval.config.robot_team import RobotTeam
from hthor.eval.config.run_config import RunConfig
from hthor.eval.config.sessions import Session, make_sessions
from hthor.eval.config.task_selection import TaskSelection
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.runner import trial_runner
from hthor.eval.runner.messages import RunnerFactory
from hthor.eval.runner.trial_runner import Sources
from hthor.guest import GuestConfig, Isolation


def make_sources(
    team: RobotTeam,
    *,
    kind_path: str = "",
    assets: str = "",
    houses: Path | None = None,
    humans: str = "",
    guests: GuestConfig | None = None,
) -> Sources:
    """The sources of all that the trials of this team need; see `Sources`."""
    return Sources(
        agent_paths=team.agent_paths,
        manifests=team.manifests,
        robot_paths=team.robot_paths,
        kind_path=kind_path,
        assets=assets,
        houses=str(houses.resolve()) if houses is not None else "",
        humans=humans,
        guests=guests or GuestConfig(),
    )


class RunJob(Struct, frozen=True, kw_only=True):
    """The parts of a run. ``sources`` says where they are."""

    config: RunConfig
    team: RobotTeam
    people: HumanTeam
    tasks: TaskSelection
    sources: Sources

    @property
    def sessions(self) -> tuple[Session, ...]:
        """The sessions of the run, or of its shard."""
        config = self.config
        sessions = make_sessions(
            self.tasks.suite,
            agent=self.team,
            humans=self.people,
            seed=config.seed,
            participants=config.participants,
            kind_sha256=config.kind.sha256 if config.kind else "",
            assets_sha256=config.assets.sha256,
            clock=config.mode,
            step_limit_s=config.step_limit_s or None,
            design=config.design or None,
        )
        return config.shard.share(sessions) if config.shard else sessions

    @property
    def make_runner(self) -> RunnerFactory:
        """The factory that makes a session runner in each worker."""
        return functools.partial(trial_runner.make_runner, self.sources)


class ScheduledRun(RunJob, frozen=True, kw_only=True):
    """A run that a command will run or resume, and where it is written.

    Attributes:
        title: the run's name in progress messages.
        isolation: how its submitted agents are isolated on this machine; None where all agents are built in.
    """

    folder: RunFolder
    title: str
    isolation: Isolation | None
