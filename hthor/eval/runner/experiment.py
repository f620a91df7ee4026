"""`hthor eval` as one function: several crews and peoples, each pair in its own run; parses and prints nothing."""

from __future__ import annotations

import functools
import os
import shlex
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Protocol

from msgspec import Struct

from hthor import guest, jsonio
from hthor.eval.config import run_config
from hthor.eval.config.robot_team import RobotTeam
from hthor.eval.config.run_config import RunConfig
from hthor.eval.config.sessions import Session, make_sessions
from hthor.eval.config.task_selection import TaskSelection
from hthor.eval.records import opened_files, run_isolation
from hthor.eval.results.result_file import RunResult
from hthor.eval.runner import engines, queue, run, run_options, trial_runner
from hthor.eval.runner.collector import InternalFailure, Unfinished
from hthor.eval.runner.engines import RunnerFactory
from hthor.eval.runner.run import Watcher
from hthor.eval.runner.run_options import ResolvedRuns, RunJob, RunOptions
from hthor.guest import GuestConfig, Isolation
from hthor.tasks.suite import encode_suite
from hthor.tasks.suites import library


class ClosableWatcher(Watcher, Protocol):
    """A watcher that has something to clear away in the end."""

    def close(self) -> None:
        """The run is over."""


class FinishedRun(Struct, frozen=True, kw_only=True):
    """A run that is whole."""

    plan: RunConfig
    folder: Path
    result: RunResult


def run_experiment(
    options: RunOptions,
    watcher: Callable[[str], ClosableWatcher],
    agree: Callable[[ResolvedRuns], bool] = lambda _: True,
) -> Iterator[FinishedRun]:
    """Run every crew's evaluation with every people; each that is whole is given at once, peoples in turn.

    Everything that the user can have got wrong is looked at before the first trial is played. A run that lacks
    trials in the end does not keep the others from being played.

    Args:
        watcher: makes who follows the run of this name.
        agree: is told what will be done before anything is; nothing is where it says no.
    """
    asked = run_options.resolve_options(options)
    for part in (*asked.parts, *asked.control_of.values()):
        run_config.check_folder(part.folder, part.plan)
        _engine(options, asked.chosen, part.crew)  # is there such an engine?
        run_isolation.weakest_isolation(
            part.folder, run_isolation.isolation_of(asked.held, part.crew.minds.values()), options.require_isolation
        )
    if not agree(asked):
        return
    told: set[str] = set()
    unfinished: list[Unfinished | InternalFailure] = []

    def perform(part: RunJob) -> RunResult | None:
        watch = watcher(part.title)
        try:
            return _perform(
                options,
                asked.chosen,
                part,
                watch,
                told,
                run_isolation.isolation_of(asked.held, part.crew.minds.values()),
            )
        except (Unfinished, InternalFailure) as error:  # the other runs go on
            unfinished.append(error)
            return None
        finally:
            watch.close()

    early: dict[Path, RunResult | None] = {}
    for part in asked.parts:
        first = asked.control_of.get(part.folder)
        if first is not None and first.folder not in early:
            early[first.folder] = perform(first)
        result = early[part.folder] if part.folder in early else perform(part)
        early[part.folder] = result
        if result is not None:
            yield FinishedRun(plan=part.plan, folder=part.folder, result=result)
    if unfinished:
        raise unfinished[0] if len(unfinished) == 1 else Unfinished(" ".join(map(str, unfinished)))


def _engine(options: RunOptions, chosen: TaskSelection, crew: RobotTeam) -> engines.Engine:
    limit_s = options.trial_limit or queue.trial_limit_s(chosen.suite.tasks, len(crew.minds), options.step_limit)
    return engines.find_engine(
        options.engine, jobs=options.jobs, address=options.address, gpus=crew.gpus, limit_s=limit_s
    )


def _perform(
    options: RunOptions,
    chosen: TaskSelection,
    part: RunJob,
    watch: ClosableWatcher,
    told: set[str],
    held: Isolation | None,
) -> RunResult:
    """One run. What was ``told`` of an earlier one is not told again."""
    crew, plan, folder = part.crew, part.plan, part.folder
    for note in chosen.notes:
        if note not in told:
            told.add(note)
            watch.note(note)
    own, guests = own_houses(options), run_options.guest_config(options)
    extra = {f"houses/{name}": data for name, data in own.items()}  # so that the run can be drawn by itself
    if chosen.drawn:
        extra["suite.json"] = encode_suite(chosen.suite)
    if held is not None:
        extra[run_isolation.NAME] = jsonio.pretty(
            run_isolation.weakest_isolation(folder, held, options.require_isolation)
        )
    return run.run_evaluation(
        plan,
        run_sessions_of(options, chosen, part),
        runner_factory(options, chosen, part, held, houses=folder / "houses" if own else None),
        folder=folder,
        engine=_engine(options, chosen, crew),
        watch=watch,
        extra=extra,
        again=_again(options, chosen, part),
        check=functools.partial(opened_files.check_opened_files, crew.minds, guests) if plan.agents else None,
    )


def run_sessions_of(options: RunOptions, chosen: TaskSelection, part: RunJob) -> tuple[Session, ...]:
    """The sessions of a run, or of its shard."""
    plan = part.plan
    dealt = make_sessions(
        chosen.suite,
        agent=part.crew,
        human=part.people,
        seed=options.seed,
        participants=plan.participants,
        kind_sha256=plan.kind.sha256 if plan.kind else "",
        assets_sha256=plan.assets.sha256,
        realtime=bool(plan.realtime),
        step_limit_s=plan.step_limit_s or None,
    )
    return plan.shard.share(dealt) if plan.shard else dealt


def runner_factory(
    options: RunOptions, chosen: TaskSelection, part: RunJob, held: Isolation | None, houses: Path | None
) -> RunnerFactory:
    """What makes a worker's player.

    Args:
        held: how the run's agents are held, None where all are built in.
        houses: the folder with the suite's own houses, None where it has none.
    """
    guests = run_options.guest_config(options)
    if held is not None:
        level = options.isolation if held.level == guest.SERVED else held.level  # of whoever is beside the served one
        guests = GuestConfig(isolation=level, hidden=(*guests.hidden, str(part.folder.resolve())), inputs=guests.inputs)
    sources = trial_runner.Sources(
        minds=part.crew.minds,
        manifests=part.crew.manifests,
        bodies=part.crew.bodies,
        kind=chosen.path,
        assets=options.assets,
        houses=str(houses.resolve()) if houses else "",
        people=part.people.word,
        guests=guests,
    )
    return functools.partial(trial_runner.make_runner, sources)


def own_houses(options: RunOptions) -> dict[str, bytes]:
    """The house files that the suite brings with it, by name; none for a suite of ours."""
    return library.house_files(options.suite) if options.suite and Path(options.suite).exists() else {}


def _again(options: RunOptions, chosen: TaskSelection, part: RunJob) -> str:
    """The command that plays a trial of a run once more, but for the trial's key, with its author looking on."""
    words = ["hthor", "agent", "run"]
    files = [("--agent", path) for path in dict.fromkeys(part.crew.minds.values())]
    files += [("--robot", path) for path in dict.fromkeys(part.crew.bodies.values())]
    files += [("--kind", chosen.path)] if chosen.path else []
    for option, path in files:
        words += [option, _near(path)]
    if part.people.word != part.people.name:
        words += ["--humans", part.people.word]
    if options.isolation != "auto" and part.crew.minds:
        words += ["--isolation", options.isolation]
    if part.crew.minds:
        words += [word for one in options.agent_args for word in ("--agent-args", one)]
        words += [word for one in options.readable for word in ("--readable", str(one))]
    return shlex.join([*words, _near(str(part.folder))])


def _near(path: str) -> str:
    """A path as short as it can be said from here; whatever is no absolute path stays as it is."""
    near = os.path.relpath(path) if os.path.isabs(path) else path
    return path if near.startswith("..") else near
