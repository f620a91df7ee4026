"""What `hthor eval` is asked to play: which runs, with whom, written where."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor import code_identity
from hthor.errors import HthorError
from hthor.eval.config import human_populations, robot_team, run_config, shard, task_selection
from hthor.eval.config.robot_team import RobotTeam
from hthor.eval.config.run_config import RunConfig
from hthor.eval.config.task_selection import TaskSelection
from hthor.eval.records import run_isolation
from hthor.eval.results import baseline
from hthor.eval.runner import engines, trial_runner
from hthor.guest import GuestConfig, Isolation
from hthor.guest.agent import inputs
from hthor.humans.population.resolve import PROXY, ParticipantSource
from hthor.tasks.suites import library
from hthor.types import cameras, detector_specs

RUNS = Path("runs")


class RunOptions(Struct, frozen=True, kw_only=True):
    """What the user asked for, empty where the default depends on the rest. ``name`` is the user's own for the run.

    With ``control``, the same people also do the same tasks without a robot, unless such a run lies there already.
    """

    agents: tuple[str, ...] = ()
    robots: str = ""
    robot: str = ""
    humans: tuple[str, ...] = (PROXY,)
    suite: str = ""
    kind: str = ""
    assets: str = ""
    detector: str = detector_specs.OWN
    camera: str = cameras.OWN
    camera_size: str = ""
    seed: int = 0
    participants: int | None = None
    jobs: int | None = None
    out: Path | None = None
    shard: str = ""
    engine: str = engines.LOCAL
    address: str = ""
    control: bool = False
    realtime: bool = False
    name: str = ""
    limit: int | None = None
    houses: tuple[str, ...] = ()
    difficulty: str = ""
    step_limit: float | None = None
    isolation: str = "auto"
    require_isolation: str = ""
    trial_limit: float | None = None
    max_faults: str = "0"
    agent_args: tuple[str, ...] = ()
    readable: tuple[Path, ...] = ()


class RunJob(Struct, frozen=True, kw_only=True):
    """One run of several: who is evaluated with whom, and where that is written."""

    crew: RobotTeam
    people: ParticipantSource
    plan: RunConfig
    folder: Path
    title: str


class ResolvedRuns(Struct, frozen=True, kw_only=True):
    """What a command stands for, when everything is settled and before anything is written: the tasks, the runs that
    were asked for, and what will hold agents of the user's own. ``control_of`` has, for the folder of each run that has
    no control yet, the run that becomes it, which may be one that was asked for.
    """

    chosen: TaskSelection
    parts: tuple[RunJob, ...]
    control_of: dict[Path, RunJob]
    held: Isolation | None

    @property
    def controls(self) -> tuple[RunJob, ...]:
        """Runs that nobody asked for, played as the control of others."""
        asked = {part.folder for part in self.parts}
        return tuple({part.folder: part for part in self.control_of.values() if part.folder not in asked}.values())


def resolve_options(options: RunOptions) -> ResolvedRuns:
    """Find out what is asked for. Nothing is written.

    Raises:
        HthorError: for whatever the user can have got wrong, but for what lies in the runs' folders already.
    """
    if not options.agents and not options.robots:
        raise HthorError(
            "name an agent with --agent, or robots and their agents with --robots tall:oracle,small:oracle."
        )
    guests = guest_config(options)
    code_identity.keep_compiled()
    whom = human_populations.find_populations(options.humans)
    detector = detector_specs.canonical_name(options.detector)
    camera = cameras.canonical_name(options.camera, options.camera_size)
    pack = trial_runner.load_pack(options.assets)
    shown = run_config.AssetsRef(name=pack.name, sha256=pack.sha256) if pack else None
    whole = task_selection.select_tasks(options.suite, options.kind)
    chosen = task_selection.limit_selection(
        task_selection.narrow_selection(whole, options.houses, options.difficulty), options.limit
    )
    parts = _parts(options, chosen, _crews(options, chosen, detector, camera, guests), whom, shown)
    controls = _controls(options, chosen, parts) if options.control and not options.shard else {}
    minds = sorted({mind for part in parts for mind in part.crew.minds.values()})
    held = run_isolation.resolve_isolation(options.isolation, options.require_isolation, minds)
    return ResolvedRuns(chosen=chosen, parts=tuple(parts), control_of=controls, held=held)


def _controls(options: RunOptions, chosen: TaskSelection, parts: Sequence[RunJob]) -> dict[Path, RunJob]:
    """For the folder of each run with robots that has no control yet, the run that is its control."""
    crew = robot_team.form_team(["scout"], [robot_team.NO_ROBOT_AGENT])
    found: dict[Path, RunJob] = {}
    for part in parts:
        if not part.plan.seats or baseline.find_baseline(part.folder, part.plan) is not None:
            continue
        same = [other for other in parts if other.people.sha256 == part.people.sha256]
        asked = next((other for other in same if not other.plan.seats), None)
        if asked is not None:
            found[part.folder] = asked
            continue
        assets = part.plan.assets if options.assets else None
        plan = run_config.build_config(
            chosen.suite,
            crew,
            human=part.people,
            seed=options.seed,
            participants=options.participants,
            kind=chosen.kind,
            assets=assets,
            limit=chosen.limit,
            houses=chosen.houses,
            difficulty=chosen.difficulty,
        )
        if options.out is None and not options.name:
            folder = RUNS / plan.folder_name
        else:
            folder = part.folder / baseline.FOLDER if len(same) == 1 else part.folder.parent / plan.crew
        title = part.title.replace(part.plan.name, robot_team.NO_ROBOT, 1)
        found[part.folder] = RunJob(crew=crew, people=part.people, plan=plan, folder=folder, title=title)
    return found


def _parts(
    options: RunOptions,
    chosen: TaskSelection,
    found: Sequence[RobotTeam],
    whom: Sequence[ParticipantSource],
    shown: run_config.AssetsRef | None,
) -> list[RunJob]:
    """Every run, each with a folder of its own."""
    parts: list[RunJob] = []
    for people in whom:
        for crew in found:
            plan = run_config.build_config(
                chosen.suite,
                crew,
                human=people,
                seed=options.seed,
                participants=options.participants,
                kind=chosen.kind,
                assets=shown,
                realtime=options.realtime,
                limit=chosen.limit,
                houses=chosen.houses,
                difficulty=chosen.difficulty,
                step_limit_s=options.step_limit,
            )
            if options.name:
                own = run_config.check_title(options.name) + (f"-{plan.crew}" if len(found) > 1 else "")
                plan = msgspec.structs.replace(plan, title=own)
            title = plan.name if len(whom) == 1 else f"{plan.name}, {people.name} people"
            folder = _folder(options, plan, len(found), len(whom))
            if options.shard:
                plan = run_config.shard_config(plan, shard.parse_shard(options.shard), len(chosen.suite.tasks))
                assert plan.shard
                title, folder = f"{title}, shard {plan.shard.words}", plan.shard.folder(folder)
            parts.append(RunJob(crew=crew, people=people, plan=plan, folder=folder, title=title))
    names = [part.plan.name for part in parts[: len(found)]]
    twice = sorted({name for name in names if names.count(name) > 1})
    if twice:
        raise HthorError(f"two agents are called '{twice[0]}'. Rename one of the files, or evaluate them one by one.")
    return parts


def guest_config(options: RunOptions) -> GuestConfig:
    """How submitted agents are isolated, and what they are given."""
    given = inputs.parse_inputs(options.agent_args, options.readable)
    return GuestConfig(isolation=options.isolation, hidden=hidden(options), inputs=given)


def hidden(options: RunOptions) -> tuple[str, ...]:
    """What no agent may read, even if it lies in its own folder: runs, tasks and people."""
    words = (*options.humans, options.suite, options.kind, str(options.out or ""))
    places = [RUNS, *(Path(word.rpartition("@")[2]) for word in words if word)]
    if options.suite and Path(options.suite).is_file():
        places.append(library.houses_folder(Path(options.suite)))
    return tuple(str(path.resolve()) for path in places if path.exists())


def _crews(
    options: RunOptions, chosen: TaskSelection, detector: str, camera: str, guests: GuestConfig | None = None
) -> list[RobotTeam]:
    """Who is evaluated, one run each."""
    if options.robots:
        if options.robot:
            raise HthorError("--robots names all the bodies; leave out --robot.")
        return robot_team.parse_teams(options.robots, options.agents, detector, camera, guests=guests)
    bodies = (options.robot,) if options.robot else chosen.crew
    if not bodies:
        raise HthorError(
            f"the kinds of task in the suite '{chosen.suite.name}' want different robots; name them with --robots, "
            "or choose one kind with --kind."
        )
    shapes = [robot_team.load_robot_info(body) for body in bodies]
    minds = [robot_team.load_agent_info(agent, guests) for agent in options.agents]
    return [robot_team.form_team(shapes, [mind] * len(shapes), detector, camera) for mind in minds]


def _folder(options: RunOptions, plan: RunConfig, crews: int, whom: int) -> Path:
    """Where a run is written: peoples have folders of their own, and agents have theirs in these."""
    base = options.out or (RUNS / options.name if options.name else None)
    if base is None:
        return RUNS / plan.folder_name
    folder = base if whom == 1 else base / plan.humans.name
    return folder if crews == 1 else folder / plan.crew
