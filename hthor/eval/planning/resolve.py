"""Resolves the options of `hthor eval`: every word becomes an object, in one pass, before anything is written."""

import functools
import os
from collections.abc import Callable, Sequence
from pathlib import Path

import msgspec

from hthor import code_identity
from hthor.errors import HthorError
from hthor.eval.config import human_populations, option, run_config, shards, study_design, task_selection
from hthor.eval.config.options import EvalOptions
from hthor.eval.planning import custom_houses, max_faults, run_teams
from hthor.eval.planning.run_planner import CommonSetting, RunPlanner
from hthor.eval.records import run_isolation
from hthor.eval.runner import engines
from hthor.eval.runner.engines import Engine
from hthor.eval.runner.run_job import RUNS, ResolvedRuns
from hthor.guest import GuestConfig
from hthor.guest.agent import inputs
from hthor.guest.host.connected_programs import ConnectedPrograms
from hthor.tasks.suites import library
from hthor.trials.robot_team import RobotTeam
from hthor.trials.sources import load_pack
from hthor.types import TaskSpec


def resolve(
    options: EvalOptions, tell: Callable[[str], None] = lambda _: None, programs: ConnectedPrograms | None = None
) -> ResolvedRuns:
    """Find out which runs the options stand for. Nothing is written but tasks in the cache, for houses of the user's.

    Args:
        tell: called with a sentence before something that takes a while.
        programs: where the programs connect that are agents of the runs; None where none can.

    Raises:
        HthorError: for any invalid option, also where a run's folder holds something else.
    """
    if not options.agent and not options.robots:
        raise HthorError(
            "name an agent with --agent, or robots and their agents with --robots tall:oracle,small:oracle."
        )
    allowed_faults = max_faults.parse_max_faults(str(options.max_faults))
    if custom_houses.files(options):
        suite = custom_houses.make_suite(options, tell)
        options = msgspec.structs.replace(options, suite=str(suite), house=(), difficulty=None, kind="")
    guests = _guest_config(options, programs)
    code_identity.keep_compiled()
    peoples = human_populations.find_people(options.humans)
    pack = load_pack(options.assets)
    tasks = task_selection.select_tasks(options.suite, options.kind)
    tasks = task_selection.narrow_selection(tasks, options.house, options.difficulty or "")
    tasks = task_selection.limit_selection(tasks, options.limit)
    teams = run_teams.choose_teams(options, tasks, guests)
    setting = CommonSetting(
        tasks=tasks,
        pack=options.assets,
        assets=run_config.AssetsRef(name=pack.name, sha256=pack.sha256) if pack else None,
        guests=guests,
        conditions=tuple(map(run_teams.agent_word, teams)) if options.design == study_design.BETWEEN else (),
        seed=options.seed,
        participants=options.participants,
        clock=options.clock,
        step_limit_s=options.step_limit,
        title=run_config.check_title(options.name) if options.name else "",
        base=options.out or (RUNS / options.name if options.name else None),
        shard=shards.parse_shard(options.shard) if options.shard else None,
        houses=library.house_files(options.suite) if options.suite and Path(options.suite).exists() else {},
        make_engine=functools.partial(_engine, options, tasks.suite.tasks),
        required_isolation=options.require_isolation,
        agent_words=tuple(option.command_words(options, only=("isolation", "agent_args", "readable"))),
        kept=option.kept_values(options),
    )
    planner = RunPlanner(setting)
    runs = planner.runs(teams, peoples)
    baselines = planner.baselines(runs) if options.control and not options.shard else {}
    submitted = sorted({agent for team in teams for agent in team.agent_paths.values()})
    isolation = run_isolation.resolve_isolation(options.isolation, options.require_isolation, submitted)
    runs = [planner.isolated(run, isolation) for run in runs]
    by_folder = {run.folder.path: run for run in runs}
    return ResolvedRuns(
        options=options,
        tasks=tasks,
        runs=tuple(runs),
        baseline_of={folder: by_folder.get(run.folder.path, run) for folder, run in baselines.items()},
        isolation=isolation,
        workers=options.jobs or len(os.sched_getaffinity(0)),
        allowed_faults=allowed_faults,
    )


def _guest_config(options: EvalOptions, programs: ConnectedPrograms | None) -> GuestConfig:
    """How submitted agents are isolated, and which arguments and files they get."""
    agent_inputs = inputs.parse_inputs(options.agent_args, options.readable)
    hidden = _hidden_paths(options)
    return GuestConfig(isolation=options.isolation, hidden=hidden, inputs=agent_inputs, programs=programs)


def _hidden_paths(options: EvalOptions) -> tuple[str, ...]:
    """Paths that no agent may read, even in its own folder: runs, tasks and human populations."""
    words = (*options.humans, options.suite, options.kind, str(options.out or ""))
    paths = [RUNS, *(Path(word.rpartition("@")[2]) for word in words if word)]
    if options.suite and Path(options.suite).is_file():
        paths.append(library.houses_folder(Path(options.suite)))
    return tuple(str(path.resolve()) for path in paths if path.exists())


def _engine(options: EvalOptions, tasks: Sequence[TaskSpec], team: RobotTeam) -> Engine:
    """The engine that plays the trials of a team."""
    limit_s = options.trial_limit or engines.trial_limit_s(tasks, len(team.agent_paths), options.step_limit)
    return engines.find_engine(
        options.engine, jobs=options.jobs, address=options.address, gpus=team.gpus, limit_s=limit_s
    )
