"""Runs as jobs: their configuration, robots, people, tasks, and the paths of everything that a worker needs."""

import functools
from collections.abc import Callable
from pathlib import Path

from msgspec import Struct

from hthor.eval.config.options import EvalOptions
from hthor.eval.config.run_config import RunConfig
from hthor.eval.config.task_selection import TaskSelection
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.runner import session_runner
from hthor.eval.runner.engines import Engine
from hthor.eval.runner.messages import RunnerFactory
from hthor.guest import Isolation
from hthor.trials import Sources
from hthor.trials.human_team import HumanTeam
from hthor.trials.robot_team import RobotTeam
from hthor.trials.sessions import Session, make_sessions

RUNS = Path("runs")
"""The folder of runs for which the user names no other."""


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
    """A run that will be run or resumed, and where it is written.

    Attributes:
        title: the run's name in progress messages.
        isolation: how its submitted agents are isolated on this machine; None where all agents are built in.
        required_isolation: the lowest acceptable level, empty for any.
        engine: where its trials are played.
        files: what makes its folder complete in itself, by name, such as the suite's own houses.
        rerun_command: the command that runs one of its trials once more, without the trial's key.
        runner: makes the session runners, if others than `RunJob.make_runner` does.
    """

    folder: RunFolder
    title: str
    isolation: Isolation | None
    required_isolation: str
    engine: Engine
    files: dict[str, bytes]
    rerun_command: str
    runner: RunnerFactory | None = None


class ResolvedRuns(Struct, frozen=True, kw_only=True):
    """The runs that some options stand for, before anything is written.

    Attributes:
        options: the options as the user gave them, except that houses of their own became a suite.
        tasks: the tasks of every run.
        runs: the runs that the user named.
        baseline_of: for the folder of each run that has no baseline yet, the run that becomes its baseline; that may be
            one of ``runs``.
        isolation: how submitted agents are isolated on this machine; None where all agents are built in.
        workers: how many processes play trials on this machine.
        allowed_faults: how many of a number of trials may have a fault.
    """

    options: EvalOptions
    tasks: TaskSelection
    runs: tuple[ScheduledRun, ...]
    baseline_of: dict[Path, ScheduledRun]
    isolation: Isolation | None
    workers: int
    allowed_faults: Callable[[int], float]

    @property
    def baselines(self) -> tuple[ScheduledRun, ...]:
        """Runs that only serve as baselines of others."""
        asked = {run.folder.path for run in self.runs}
        others = (run for run in self.baseline_of.values() if run.folder.path not in asked)
        return tuple({run.folder.path: run for run in others}.values())
