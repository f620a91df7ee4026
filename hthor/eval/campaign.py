"""`hthor eval` as one function: several crews and peoples, each pair in its own run; parses and prints nothing."""

from __future__ import annotations

import functools
import os
import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Protocol

from msgspec import Struct

from hthor import detectors, guest, jsonio
from hthor.errors import HthorError
from hthor.eval import (
    cast,
    control,
    crews,
    engines,
    guarded,
    peoples,
    programme,
    provenance,
    run,
    setup,
    shard,
    waiting,
)
from hthor.eval.course import InternalFailure, Unfinished
from hthor.eval.crews import Crew
from hthor.eval.programme import Programme
from hthor.eval.run import Watcher
from hthor.eval.score import Result
from hthor.eval.session import sessions
from hthor.eval.setup import Setup
from hthor.guest import Isolation
from hthor.humans.people import PROXY, People
from hthor.tasks import library

RUNS = Path("runs")


class Options(Struct, frozen=True, kw_only=True):
    """What the user asked for, empty where the default depends on the rest.

    With ``control``, the same people also do the same tasks without a robot, unless such a run lies there already.
    """

    agents: tuple[str, ...] = ()
    robots: str = ""
    robot: str = ""
    humans: tuple[str, ...] = (PROXY,)
    suite: str = ""
    kind: str = ""
    assets: str = ""
    detector: str = detectors.OWN
    seed: int = 0
    participants: int | None = None
    jobs: int | None = None
    out: Path | None = None
    shard: str = ""
    engine: str = engines.LOCAL
    address: str = ""
    control: bool = False
    realtime: bool = False
    isolation: str = "auto"
    require_isolation: str = ""
    trial_limit: float | None = None


class ClosableWatcher(Watcher, Protocol):
    """A watcher that has something to clear away in the end."""

    def close(self) -> None:
        """The run is over."""


class Part(Struct, frozen=True, kw_only=True):
    """One run of several: who is evaluated with whom, and where that is written."""

    crew: Crew
    people: People
    plan: Setup
    folder: Path
    title: str


class Intent(Struct, frozen=True, kw_only=True):
    """What a command stands for, when everything is settled and before anything is written: the runs that were asked
    for, those that are played as their controls, and what will hold agents of the user's own.
    """

    parts: tuple[Part, ...]
    controls: tuple[Part, ...]
    held: Isolation | None


class Done(Struct, frozen=True, kw_only=True):
    """A run that is whole."""

    plan: Setup
    folder: Path
    result: Result


def conduct(
    options: Options,
    watcher: Callable[[str], ClosableWatcher],
    agree: Callable[[Intent], bool] = lambda _: True,
) -> Iterator[Done]:
    """Run every crew's evaluation with every people; each that is whole is given at once, peoples in turn.

    Everything that the user can have got wrong is looked at before the first trial is played. A run that lacks
    trials in the end does not keep the others from being played.

    Args:
        watcher: makes who follows the run of this name.
        agree: is told what will be done before anything is; nothing is where it says no.
    """
    if not options.agents and not options.robots:
        raise HthorError(
            "name an agent with --agent, or robots and their agents with --robots tall:oracle,small:oracle."
        )
    guest.confine_guests(options.isolation, _hidden(options))
    os.environ.setdefault("NUMBA_CACHE_DIR", str(provenance.compiled()))  # for what agents import of ours
    whom = peoples.expand(options.humans)
    detector = detectors.tidy(options.detector)
    pack = cast.furnish(options.assets)
    shown = setup.AssetsRef(name=pack.name, sha256=pack.sha256) if pack else None
    chosen = programme.choose(options.suite, options.kind)
    parts = _parts(options, chosen, _crews(options, chosen, detector), whom, shown)
    controls = _controls(options, chosen, parts) if options.control and not options.shard else {}
    held = guarded.settle(options.isolation, options.require_isolation, _minds(parts))
    for part in (*parts, *controls.values()):
        setup.examine(part.folder, part.plan)
        _engine(options, chosen, part.crew)  # is there such an engine?
        guarded.weakest(part.folder, guarded.of(held, part.crew.minds.values()), options.require_isolation)
    if not agree(_intent(parts, controls, held)):
        return
    told: set[str] = set()
    unfinished: list[Unfinished | InternalFailure] = []

    def perform(part: Part) -> Result | None:
        watch = watcher(part.title)
        try:
            return _perform(options, chosen, part, watch, told, guarded.of(held, part.crew.minds.values()))
        except (Unfinished, InternalFailure) as error:  # the other runs go on
            unfinished.append(error)
            return None
        finally:
            watch.close()

    early: dict[Path, Result | None] = {}
    for part in parts:
        first = controls.get(part.folder)
        if first is not None and first.folder not in early:
            early[first.folder] = perform(first)
        result = early[part.folder] if part.folder in early else perform(part)
        early[part.folder] = result
        if result is not None:
            yield Done(plan=part.plan, folder=part.folder, result=result)
    if unfinished:
        raise unfinished[0] if len(unfinished) == 1 else Unfinished(" ".join(map(str, unfinished)))


def _intent(parts: Sequence[Part], controls: Mapping[Path, Part], held: Isolation | None) -> Intent:
    asked = {part.folder for part in parts}
    more = {part.folder: part for part in controls.values() if part.folder not in asked}
    return Intent(parts=tuple(parts), controls=tuple(more.values()), held=held)


def _controls(options: Options, chosen: Programme, parts: Sequence[Part]) -> dict[Path, Part]:
    """For the folder of each run with robots that has no control yet, the run that is its control."""
    crew = crews.form(["scout"], ["silent"])
    found: dict[Path, Part] = {}
    for part in parts:
        if not part.plan.seats or control.find(part.folder, part.plan) is not None:
            continue
        same = [other for other in parts if other.people.sha256 == part.people.sha256]
        asked = next((other for other in same if not other.plan.seats), None)
        if asked is not None:
            found[part.folder] = asked
            continue
        assets = part.plan.assets if options.assets else None
        plan = setup.settle(
            chosen.suite,
            crew,
            human=part.people,
            seed=options.seed,
            participants=options.participants,
            kind=chosen.kind,
            assets=assets,
        )
        if options.out is None:
            folder = RUNS / plan.folder_name
        else:
            folder = part.folder / control.FOLDER if len(same) == 1 else part.folder.parent / plan.name
        title = part.title.replace(part.plan.name, "control, no robot", 1)
        found[part.folder] = Part(crew=crew, people=part.people, plan=plan, folder=folder, title=title)
    return found


def _parts(
    options: Options,
    chosen: Programme,
    found: Sequence[Crew],
    whom: Sequence[People],
    shown: setup.AssetsRef | None,
) -> list[Part]:
    """Every run, each with a folder of its own."""
    parts: list[Part] = []
    for people in whom:
        for crew in found:
            plan = setup.settle(
                chosen.suite,
                crew,
                human=people,
                seed=options.seed,
                participants=options.participants,
                kind=chosen.kind,
                assets=shown,
                realtime=options.realtime,
            )
            title = plan.name if len(whom) == 1 else f"{plan.name}, {people.name} people"
            folder = _folder(options, plan, len(found), len(whom))
            if options.shard:
                plan = setup.divide(plan, shard.read(options.shard), len(chosen.suite.tasks))
                assert plan.shard
                title, folder = f"{title}, shard {plan.shard.words}", plan.shard.folder(folder)
            parts.append(Part(crew=crew, people=people, plan=plan, folder=folder, title=title))
    names = [part.plan.name for part in parts[: len(found)]]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise HthorError(f"two agents are called '{twice[0]}'. Rename one of the files, or evaluate them one by one.")
    return parts


def _minds(parts: Sequence[Part]) -> list[str]:
    """Every submitted agent, once."""
    return sorted({mind for part in parts for mind in part.crew.minds.values()})


def _engine(options: Options, chosen: Programme, crew: Crew) -> engines.Engine:
    limit_s = options.trial_limit or waiting.limit(chosen.suite.tasks, len(crew.minds))
    return engines.find(options.engine, jobs=options.jobs, address=options.address, gpus=crew.gpus, limit_s=limit_s)


def _perform(
    options: Options,
    chosen: Programme,
    part: Part,
    watch: ClosableWatcher,
    told: set[str],
    held: Isolation | None,
) -> Result:
    """One run. What was ``told`` of an earlier one is not told again."""
    crew, plan, folder = part.crew, part.plan, part.folder
    dealt = sessions(
        chosen.suite,
        agent=crew,
        human=part.people,
        seed=options.seed,
        participants=plan.participants,
        kind_sha256=plan.kind.sha256 if plan.kind else "",
        assets_sha256=plan.assets.sha256 if options.assets else "",
        realtime=bool(plan.realtime),
    )
    for note in (*chosen.notes, *(f"{note}." for note in plan.humans.notes)):
        if note not in told:
            told.add(note)
            watch.note(note)
    own = library.own_houses(options.suite) if options.suite and Path(options.suite).exists() else {}
    extra = {f"houses/{name}": data for name, data in own.items()}  # so that the run can be drawn by itself
    if chosen.drawn:
        extra["suite.json"] = library.encode(chosen.suite)
    sources = cast.Sources(
        minds=crew.minds,
        bodies=crew.bodies,
        kind=chosen.path,
        assets=options.assets,
        houses=str((folder / "houses").resolve()) if own else "",
        people=part.people.word,
    )
    make = functools.partial(cast.player, sources)
    if held is not None:
        hidden = (*_hidden(options), str(folder.resolve()))
        make = functools.partial(guarded.player, sources, held.level, hidden)
        extra[guarded.NAME] = jsonio.pretty(guarded.weakest(folder, held, options.require_isolation))
    mine = plan.shard.share(dealt) if plan.shard else dealt
    return run.evaluate(
        plan,
        mine,
        make,
        folder=folder,
        engine=_engine(options, chosen, crew),
        watch=watch,
        extra=extra,
        again=_again(options, chosen, part),
    )


def _again(options: Options, chosen: Programme, part: Part) -> str:
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
    return shlex.join([*words, _near(str(part.folder))])


def _near(path: str) -> str:
    """A path as short as it can be said from here; whatever is no absolute path stays as it is."""
    near = os.path.relpath(path) if os.path.isabs(path) else path
    return path if near.startswith("..") else near


def _hidden(options: Options) -> tuple[str, ...]:
    """What no agent may read, even if it lies in its own folder: runs, tasks and people."""
    words = (*options.humans, options.suite, options.kind, str(options.out or ""))
    places = [RUNS, *(Path(word.rpartition("@")[2]) for word in words if word)]
    return tuple(str(path.resolve()) for path in places if path.exists())


def _crews(options: Options, chosen: Programme, detector: str) -> list[Crew]:
    """Who is evaluated, one run each."""
    if options.robots:
        if options.robot:
            raise HthorError("--robots names all the bodies; leave out --robot.")
        return crews.read(options.robots, options.agents, detector)
    bodies = (options.robot,) if options.robot else chosen.crew
    if not bodies:
        raise HthorError(
            f"the kinds of task in the suite '{chosen.suite.name}' want different robots; name them with --robots, "
            "or choose one kind with --kind."
        )
    shapes = [crews.embody(body) for body in bodies]
    minds = [crews.introduce(agent) for agent in options.agents]
    return [crews.form(shapes, [mind] * len(shapes), detector) for mind in minds]


def _folder(options: Options, plan: Setup, crews: int, whom: int) -> Path:
    """Where a run is written: peoples have folders of their own, and agents have theirs in these."""
    if options.out is None:
        return RUNS / plan.folder_name
    folder = options.out if whom == 1 else options.out / plan.humans.name
    return folder if crews == 1 else folder / plan.name
