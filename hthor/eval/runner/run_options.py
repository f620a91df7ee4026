"""The options of `hthor eval`, and the runs that they stand for."""

from collections.abc import Sequence
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor import code_identity, guest
from hthor.errors import HthorError
from hthor.eval.config import human_populations, run_config, shards, study_design, task_selection
from hthor.eval.config.run_config import AssetsRef, RunConfig
from hthor.eval.config.study_design import StudyDesign
from hthor.eval.config.task_selection import TaskSelection
from hthor.eval.records import run_isolation
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.results import baseline
from hthor.eval.runner import engines, run_teams
from hthor.eval.runner.run_job import ScheduledRun
from hthor.eval.runner.run_teams import TeamOptions
from hthor.guest import GuestConfig, Isolation
from hthor.guest.agent import inputs
from hthor.humans.population.resolve import PROXY
from hthor.tasks.suites import library
from hthor.trials import make_sources, robot_team, sessions
from hthor.trials.human_team import HumanTeam
from hthor.trials.robot_team import RobotTeam
from hthor.trials.sources import load_pack
from hthor.types.specs import LOCKSTEP, Clock

RUNS = Path("runs")


class RunOptions(TeamOptions, frozen=True, kw_only=True):
    """The options of `hthor eval`, which docs/cli.md explains; empty where the default depends on other options.

    ``control`` adds a run of the same people with the same tasks without a robot, unless there is one already. In a
    between-subjects ``design`` it adds the condition without a robot, with people of its own.
    """

    humans: tuple[str, ...] = (PROXY,)
    suite: str = ""
    kind: str = ""
    assets: str = ""
    seed: int = 0
    participants: int | None = None
    jobs: int | None = None
    out: Path | None = None
    shard: str = ""
    engine: str = engines.LOCAL
    address: str = ""
    clock: Clock = LOCKSTEP
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


class ResolvedRuns(Struct, frozen=True, kw_only=True):
    """The runs that the options stand for, before anything is written.

    Attributes:
        tasks: the tasks of every run.
        runs: the runs that the user named.
        baseline_of: for the folder of each run that has no baseline yet, the run that becomes its baseline; that may be
            one of ``runs``.
        isolation: how submitted agents are isolated on this machine; None where all agents are built in.
    """

    tasks: TaskSelection
    runs: tuple[ScheduledRun, ...]
    baseline_of: dict[Path, ScheduledRun]
    isolation: Isolation | None

    @property
    def baselines(self) -> tuple[ScheduledRun, ...]:
        """Runs that only serve as baselines of others."""
        asked = {run.folder.path for run in self.runs}
        others = (run for run in self.baseline_of.values() if run.folder.path not in asked)
        return tuple({run.folder.path: run for run in others}.values())


def resolve_options(options: RunOptions) -> ResolvedRuns:
    """Find out which runs the options stand for. Nothing is written.

    Raises:
        HthorError: for any invalid option; the content of the runs' folders is not checked.
    """
    if not options.agents and not options.robots:
        raise HthorError(
            "name an agent with --agent, or robots and their agents with --robots tall:oracle,small:oracle."
        )
    guests = guest_config(options)
    code_identity.keep_compiled()
    peoples = human_populations.find_people(options.humans)
    pack = load_pack(options.assets)
    assets = run_config.AssetsRef(name=pack.name, sha256=pack.sha256) if pack else None
    tasks = task_selection.select_tasks(options.suite, options.kind)
    tasks = task_selection.narrow_selection(tasks, options.houses, options.difficulty)
    tasks = task_selection.limit_selection(tasks, options.limit)
    teams = run_teams.choose_teams(options, tasks, guests)
    planner = _Planner(options, tasks, assets, guests, [run_teams.agent_word(team) for team in teams])
    drafts = planner.runs(teams, peoples)
    baselines = planner.baselines(drafts) if options.control and not options.shard else {}
    agents = sorted({agent for run in drafts for agent in run.team.agent_paths.values()})
    isolation = run_isolation.resolve_isolation(options.isolation, options.require_isolation, agents)
    runs = tuple(planner.isolated(run, isolation) for run in drafts)
    by_folder = {run.folder.path: run for run in runs}
    return ResolvedRuns(
        tasks=tasks,
        runs=runs,
        baseline_of={folder: by_folder.get(run.folder.path, run) for folder, run in baselines.items()},
        isolation=isolation,
    )


class _Planner:
    """Makes the runs that some options stand for; all have the same tasks and furniture."""

    def __init__(
        self,
        options: RunOptions,
        tasks: TaskSelection,
        assets: AssetsRef | None,
        guests: GuestConfig,
        conditions: Sequence[str],
    ) -> None:
        self._options, self._tasks, self._assets, self._guests = options, tasks, assets, guests
        self._conditions = conditions
        self._brings_houses = bool(own_houses(options))

    def runs(self, teams: Sequence[RobotTeam], peoples: Sequence[HumanTeam]) -> list[ScheduledRun]:
        """Every team with all people, each in a folder of its own."""
        sizes = len(teams), len(peoples)
        runs = [self._run(team, people, *sizes) for people in peoples for team in teams]
        names = [run.config.name for run in runs[: len(teams)]]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise HthorError(
                f"two agents are called '{twice[0]}'. Rename one of the files, or evaluate them one by one."
            )
        return runs

    def baselines(self, runs: Sequence[ScheduledRun]) -> dict[Path, ScheduledRun]:
        """For the folder of each run with robots that has no baseline yet, the run that becomes its baseline."""
        team = robot_team.form_team(["scout"], [robot_team.NO_ROBOT_AGENT])
        found: dict[Path, ScheduledRun] = {}
        for run in runs:
            if not run.config.seats or baseline.find_baseline(run.folder.path, run.config) is not None:
                continue
            same = [other for other in runs if other.people.sha256 == run.people.sha256]
            asked = next((other for other in same if not other.config.seats), None)
            found[run.folder.path] = asked or self._baseline(run, team, only=len(same) == 1)
        return found

    def isolated(self, run: ScheduledRun, isolation: Isolation | None) -> ScheduledRun:
        """The run with the isolation of its agents, which cannot read the run's folder."""
        own = run_isolation.isolation_of(isolation, run.team.agent_paths.values())
        if own is None:
            return run
        level = self._options.isolation if own.level == guest.SERVED else own.level  # for agents next to a served one
        hidden = (*self._guests.hidden, str(run.folder.path.resolve()))
        guests = GuestConfig(isolation=level, hidden=hidden, inputs=self._guests.inputs)
        sources = msgspec.structs.replace(run.sources, guests=guests)
        return msgspec.structs.replace(run, sources=sources, isolation=own)

    def _run(self, team: RobotTeam, people: HumanTeam, teams: int, peoples: int) -> ScheduledRun:
        options = self._options
        config = self._config(team, people, self._assets)
        if options.name:
            own = run_config.check_title(options.name) + (f"-{config.team_name}" if teams > 1 else "")
            config = msgspec.structs.replace(config, title=own)
        title = config.name if peoples == 1 else f"{config.name}, {people.name} people"
        path = _folder(options, config, teams, peoples)
        if options.shard:
            number = shards.parse_shard(options.shard)
            config = run_config.shard_config(config, number, len(self._tasks.suite.tasks))
            title, path = f"{title}, shard {number.words}", number.folder(path)
        return self._job(team, people, config, path, title)

    def _baseline(self, run: ScheduledRun, team: RobotTeam, *, only: bool) -> ScheduledRun:
        """A run without a robot for this one; ``only`` when no other run has the same people."""
        config = self._config(team, run.people, run.config.assets if self._options.assets else None, baseline=True)
        if self._options.out is None and not self._options.name:
            path = RUNS / config.folder_name
        else:
            own = run.folder.path
            path = own / baseline.FOLDER if only else own.parent / config.team_name
        title = run.title.replace(run.config.name, robot_team.NO_ROBOT, 1)
        return self._job(team, run.people, config, path, title)

    def _config(
        self, team: RobotTeam, people: HumanTeam, assets: AssetsRef | None, *, baseline: bool = False
    ) -> RunConfig:
        options, tasks = self._options, self._tasks
        return run_config.build_config(
            tasks.suite,
            team,
            humans=people,
            seed=options.seed,
            participants=options.participants,
            kind=tasks.kind,
            assets=assets,
            clock=LOCKSTEP if baseline else options.clock,
            limit=tasks.limit,
            houses=tasks.houses,
            difficulty=tasks.difficulty,
            step_limit_s=None if baseline else options.step_limit,
            design=self._design(team, people),
        )

    def _design(self, team: RobotTeam, people: HumanTeam) -> StudyDesign | None:
        """The between-subjects study that a run is a condition of; None for the paired design."""
        if self._options.design != study_design.BETWEEN:
            return None
        return study_design.plan_study(
            self._conditions,
            run_teams.agent_word(team),
            participants=self._options.participants,
            sessions_each=sessions.sessions_needed(len(self._tasks.suite.tasks)),
            people=len(people.members),
        )

    def _job(self, team: RobotTeam, people: HumanTeam, config: RunConfig, path: Path, title: str) -> ScheduledRun:
        return ScheduledRun(
            config=config,
            team=team,
            people=people,
            tasks=self._tasks,
            sources=make_sources(
                team,
                kind_path=self._tasks.kind_path,
                assets=self._options.assets,
                houses=path / "houses" if self._brings_houses else None,
                humans=people.word,
                guests=self._guests,
            ),
            folder=RunFolder(path),
            title=title,
            isolation=None,
        )


def own_houses(options: RunOptions) -> dict[str, bytes]:
    """The house files that the suite brings with it, by name; none for a suite that ships with hthor."""
    return library.house_files(options.suite) if options.suite and Path(options.suite).exists() else {}


def guest_config(options: RunOptions) -> GuestConfig:
    """How submitted agents are isolated, and which arguments and files they get."""
    agent_inputs = inputs.parse_inputs(options.agent_args, options.readable)
    return GuestConfig(isolation=options.isolation, hidden=_hidden_paths(options), inputs=agent_inputs)


def _hidden_paths(options: RunOptions) -> tuple[str, ...]:
    """Paths that no agent may read, even in its own folder: runs, tasks and human populations."""
    words = (*options.humans, options.suite, options.kind, str(options.out or ""))
    paths = [RUNS, *(Path(word.rpartition("@")[2]) for word in words if word)]
    if options.suite and Path(options.suite).is_file():
        paths.append(library.houses_folder(Path(options.suite)))
    return tuple(str(path.resolve()) for path in paths if path.exists())


def _folder(options: RunOptions, config: RunConfig, teams: int, peoples: int) -> Path:
    """The folder of a run: one folder for the same people and in it one per team, where there are several."""
    base = options.out or (RUNS / options.name if options.name else None)
    if base is None:
        return RUNS / config.folder_name
    folder = base if peoples == 1 else base / config.humans.name
    return folder if teams == 1 else folder / config.team_name
