"""Makes the runs of an evaluation: each team with all people, their baselines, folders, engines and files."""

import os
import shlex
from collections.abc import Callable, Sequence
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor import guest
from hthor.errors import HthorError
from hthor.eval.config import run_config, study_design
from hthor.eval.config.run_config import AssetsRef, RunConfig
from hthor.eval.config.shards import Shard
from hthor.eval.config.study_design import StudyDesign
from hthor.eval.config.task_selection import TaskSelection
from hthor.eval.planning import run_teams
from hthor.eval.records import run_isolation
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.results import baseline
from hthor.eval.runner.engines import Engine
from hthor.eval.runner.run_job import RUNS, ScheduledRun
from hthor.guest import GuestConfig, Isolation
from hthor.tasks.suite import encode_suite
from hthor.trials import make_sources, robot_team, sessions
from hthor.trials.human_team import HumanTeam
from hthor.trials.robot_team import RobotTeam
from hthor.types.specs import LOCKSTEP, Clock


class CommonSetting(Struct, frozen=True, kw_only=True):
    """What all runs of an evaluation have in common.

    Attributes:
        pack: the furniture pack's name, empty for our own furniture; ``assets`` is its entry in `run.json`.
        conditions: the agents of a between-subjects study, in the words of the command line; empty for paired runs.
        base: the folder that the user chose, or that follows from the run's ``title``; None where neither was given.
        houses: the house files that the suite brings with it, by name.
        make_engine: the engine that plays the trials of a team.
        agent_words: the options of the command line that submitted agents were started with.
        kept: the options that a run keeps for the command that goes on with it.
    """

    tasks: TaskSelection
    pack: str
    assets: AssetsRef | None
    guests: GuestConfig
    conditions: tuple[str, ...]
    seed: int
    participants: int | None
    clock: Clock
    step_limit_s: float | None
    title: str
    base: Path | None
    shard: Shard | None
    houses: dict[str, bytes]
    make_engine: Callable[[RobotTeam], Engine]
    required_isolation: str
    agent_words: tuple[str, ...]
    kept: dict[str, str | float]


class RunPlanner:
    """Makes the runs of an evaluation."""

    def __init__(self, setting: CommonSetting) -> None:
        self._setting = setting

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
        common = self._setting.guests
        level = common.isolation if own.level == guest.SERVED else own.level  # for agents next to a served one
        hidden = (*common.hidden, str(run.folder.path.resolve()))
        guests = msgspec.structs.replace(common, isolation=level, hidden=hidden)
        sources = msgspec.structs.replace(run.sources, guests=guests)
        return msgspec.structs.replace(run, sources=sources, isolation=own)

    def _run(self, team: RobotTeam, people: HumanTeam, teams: int, peoples: int) -> ScheduledRun:
        setting = self._setting
        config = self._config(team, people, setting.assets)
        if setting.title:
            own = setting.title + (f"-{config.team_name}" if teams > 1 else "")
            config = msgspec.structs.replace(config, title=own)
        title = config.name if peoples == 1 else f"{config.name}, {people.name} people"
        path = self._folder(config, teams, peoples)
        if setting.shard:
            config = run_config.shard_config(config, setting.shard, len(setting.tasks.suite.tasks))
            title, path = f"{title}, shard {setting.shard.words}", setting.shard.folder(path)
        return self._scheduled(team, people, config, path, title)

    def _folder(self, config: RunConfig, teams: int, peoples: int) -> Path:
        """The folder of a run: one folder for the same people and in it one per team, where there are several."""
        base = self._setting.base
        if base is None:
            return RUNS / config.folder_name
        folder = base if peoples == 1 else base / config.humans.name
        return folder if teams == 1 else folder / config.team_name

    def _baseline(self, run: ScheduledRun, team: RobotTeam, *, only: bool) -> ScheduledRun:
        """A run without a robot for this one; ``only`` when no other run has the same people."""
        config = self._config(team, run.people, run.config.assets if self._setting.pack else None, baseline=True)
        if self._setting.base is None:
            path = RUNS / config.folder_name
        else:
            own = run.folder.path
            path = own / baseline.FOLDER if only else own.parent / config.team_name
        title = run.title.replace(run.config.name, robot_team.NO_ROBOT, 1)
        return self._scheduled(team, run.people, config, path, title)

    def _config(
        self, team: RobotTeam, people: HumanTeam, assets: AssetsRef | None, *, baseline: bool = False
    ) -> RunConfig:
        setting, tasks = self._setting, self._setting.tasks
        config = run_config.build_config(
            tasks.suite,
            team,
            humans=people,
            seed=setting.seed,
            participants=setting.participants,
            kind=tasks.kind,
            assets=assets,
            clock=LOCKSTEP if baseline else setting.clock,
            limit=tasks.limit,
            houses=tasks.houses,
            difficulty=tasks.difficulty,
            step_limit_s=None if baseline else setting.step_limit_s,
            design=self._design(team, people),
        )
        return msgspec.structs.replace(config, options=setting.kept or msgspec.UNSET)

    def _design(self, team: RobotTeam, people: HumanTeam) -> StudyDesign | None:
        """The between-subjects study that a run is a condition of; None for the paired design."""
        if not self._setting.conditions:
            return None
        return study_design.plan_study(
            self._setting.conditions,
            run_teams.agent_word(team),
            participants=self._setting.participants,
            sessions_each=sessions.sessions_needed(len(self._setting.tasks.suite.tasks)),
            people=len(people.members),
        )

    def _scheduled(self, team: RobotTeam, people: HumanTeam, config: RunConfig, path: Path, title: str) -> ScheduledRun:
        setting, tasks, folder = self._setting, self._setting.tasks, RunFolder(path)
        files = {f"houses/{name}": data for name, data in setting.houses.items()}
        if tasks.generated:
            files["suite.json"] = encode_suite(tasks.suite)
        return ScheduledRun(
            config=config,
            team=team,
            people=people,
            tasks=tasks,
            sources=make_sources(
                team,
                kind_path=tasks.kind_path,
                assets=setting.pack,
                houses=path / "houses" if setting.houses else None,
                humans=people.word,
                guests=setting.guests,
            ),
            folder=folder,
            title=title,
            isolation=None,
            required_isolation=setting.required_isolation,
            engine=setting.make_engine(team),
            files=files,
            rerun_command=_rerun_command(team, people, tasks, folder, setting.agent_words),
        )


def _rerun_command(
    team: RobotTeam, people: HumanTeam, tasks: TaskSelection, folder: RunFolder, agent_words: Sequence[str]
) -> str:
    """The `hthor agent run` command that runs a trial of a run once more, without the trial's key."""
    words = ["hthor", "agent", "run"]
    words += [word for path in dict.fromkeys(team.agent_paths.values()) for word in ("--agent", _relative(path))]
    words += [word for path in dict.fromkeys(team.robot_paths.values()) for word in ("--robot", _relative(path))]
    words += ["--kind", _relative(tasks.kind_path)] if tasks.kind_path else []
    words += ["--humans", people.word] if people.word != people.name else []
    words += agent_words if team.agent_paths else []
    return shlex.join([*words, _relative(str(folder))])


def _relative(path: str) -> str:
    """An absolute path relative to the current folder, if it is below it; any other text unchanged."""
    relative = os.path.relpath(path) if os.path.isabs(path) else path
    return path if relative.startswith("..") else relative
