"""`hthor eval` as one function: several agents, one after the other, each in its own run; parses and prints nothing."""

from __future__ import annotations

import functools
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Protocol

from msgspec import Struct

from hthor import detectors, plugins, tasks
from hthor.errors import HthorError, UnknownName
from hthor.eval import cast, run, setup
from hthor.eval.run import Watcher
from hthor.eval.score import Result
from hthor.eval.session import sessions
from hthor.eval.setup import Setup

RUNS = Path("runs")


class Options(Struct, frozen=True, kw_only=True):
    """What the user asked for; ``participants``, ``jobs`` and ``out`` have defaults that depend on the rest."""

    agents: tuple[str, ...]
    human: str = "proxy"
    suite: str = "smoke"
    robot: str = "scout"
    assets: str = ""
    detector: str = detectors.OWN
    seed: int = 0
    participants: int | None = None
    jobs: int | None = None
    out: Path | None = None


class ClosableWatcher(Watcher, Protocol):
    """A watcher that has something to clear away in the end."""

    def close(self) -> None:
        """The run is over."""


class Done(Struct, frozen=True, kw_only=True):
    """A run that is whole."""

    plan: Setup
    folder: Path
    result: Result


def conduct(options: Options, watcher: Callable[[str], ClosableWatcher]) -> Iterator[Done]:
    """Run every agent's evaluation; each that is whole is given at once.

    Everything that the user can have got wrong is looked at before the first trial is played.

    Args:
        watcher: makes who follows the run of the agent with this name.
    """
    suite = tasks.suite(options.suite)
    if options.human not in plugins.names("human model"):
        raise UnknownName("human model", options.human, plugins.names("human model"), "Choose one with --humans.")
    body, pack = cast.embody(options.robot), cast.furnish(options.assets)
    detector = detectors.tidy(options.detector)
    characters = [cast.introduce(agent) for agent in options.agents]
    names = [character.ref.name for character in characters]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise HthorError(f"two agents are called '{twice[0]}'. Rename one of the files, or evaluate them one by one.")
    plans = [
        setup.settle(
            suite,
            character,
            robot=body.name,
            human=options.human,
            seed=options.seed,
            participants=options.participants,
            detector=detector,
            robot_sha256=body.sha256,
            assets=setup.AssetsRef(name=pack.name, sha256=pack.sha256) if pack else None,
        )
        for character in characters
    ]
    folders = [_folder(options, plan) for plan in plans]
    for folder, plan in zip(folders, plans, strict=True):
        setup.examine(folder, plan)
    jobs = options.jobs or len(os.sched_getaffinity(0))
    for character, plan, folder in zip(characters, plans, folders, strict=True):
        dealt = sessions(
            suite,
            agent=character,
            robot=body.name,
            human=options.human,
            seed=options.seed,
            participants=plan.participants,
            detector=detector,
            robot_sha256=body.sha256,
            assets_sha256=pack.sha256 if pack else "",
        )
        watch = watcher(plan.agent.name)
        try:
            make = functools.partial(cast.player, character.path, body.path, options.assets)
            result = run.evaluate(plan, dealt, make, folder=folder, jobs=jobs, watch=watch)
        finally:
            watch.close()
        yield Done(plan=plan, folder=folder, result=result)


def _folder(options: Options, plan: Setup) -> Path:
    if options.out is None:
        return RUNS / plan.folder_name
    return options.out if len(options.agents) == 1 else options.out / plan.agent.name
