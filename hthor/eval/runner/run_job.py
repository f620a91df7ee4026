"""One run as a job: its configuration, robots, people, tasks, and the paths of everything that a worker needs."""

import functools

from msgspec import Struct

from hthor.eval.config.run_config import RunConfig
from hthor.eval.config.task_selection import TaskSelection
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.runner import session_runner
from hthor.eval.runner.messages import RunnerFactory
from hthor.guest import Isolation
from hthor.trials import Sources
from hthor.trials.human_team import HumanTeam
from hthor.trials.robot_team import RobotTeam
from hthor.trials.sessions import Session, make_sessions


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
        numbers = config.design.sessions(config.seed, len(self.people.members)) if config.design else None
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
            numbers=numbers,
        )
        return config.shard.share(sessions) if config.shard else sessions

    @property
    def make_runner(self) -> RunnerFactory:
        """The factory that makes a session runner in each worker."""
        return functools.partial(session_runner.make_runner, self.sources)


class ScheduledRun(RunJob, frozen=True, kw_only=True):
    """A run that a command will run or resume, and where it is written.

    Attributes:
        title: the run's name in progress messages.
        isolation: how its submitted agents are isolated on this machine; None where all agents are built in.
    """

    folder: RunFolder
    title: str
    isolation: Isolation | None
