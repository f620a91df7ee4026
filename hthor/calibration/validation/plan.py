"""The plan of a validation's runs: their people, suites and folders."""

from collections.abc import Iterator
from pathlib import Path
from typing import Literal

from msgspec import Struct

from hthor import code_identity, jsonio, rules, seeds, tasks
from hthor.calibration.simulation.trial_table import AGENTS
from hthor.calibration.validation.report.study_groups import PEOPLE
from hthor.errors import HthorError
from hthor.eval import dry_run
from hthor.eval.config import human_populations
from hthor.eval.config.options import EvalOptions
from hthor.eval.dry_run import RunForecast
from hthor.eval.planning.resolve import resolve
from hthor.eval.runner import experiment
from hthor.eval.runner.run_job import RUNS, ResolvedRuns
from hthor.humans.population import kinds
from hthor.humans.population.resolve import PROXY, resolve_humans

SUITE = "paper"
QUICK = 12
"""Most participants per condition of a quick run: two study groups, enough to see that everything works."""
RIVALS = human_populations.EXTREMES
_RIVAL_MOST, _KIND_MOST = 30, 20
"""Most participants per condition for a simple model, and for each kind of people."""


class ValidationOptions(Struct, frozen=True, kw_only=True):
    """The user's options.

    Attributes:
        name: the people, as `hthor.humans.population.resolve.resolve_humans` reads it.
        calibration: folder of the calibration that made these people; None for the evidence shipped with them.
        suites: other suites on which to rank the robots. kinds: whether to run every kind of people too.
        quick: few people and no simple models; the results are not judged.
    """

    name: str = PROXY
    calibration: Path | None = None
    participants: int = 60
    out: Path | None = None
    jobs: int | None = None
    seed: int = 0
    quick: bool = False
    kinds: bool = False
    suites: tuple[str, ...] = ()

    @property
    def count(self) -> int:
        """Participants in each condition."""
        return min(QUICK, self.participants) if self.quick else self.participants


class ValidationRun(Struct, frozen=True, kw_only=True):
    """People who do a suite in all conditions, and their ``role``; ``word`` as `resolve_humans` reads it."""

    word: str
    suite: str
    participants: int
    role: Literal["judged", "rival", "kind", "suite"]


def planned_runs(options: ValidationOptions) -> tuple[ValidationRun, ...]:
    """All runs, in order.

    Raises:
        UnknownName: when no people or no suite have that name.
        HthorError: when there are too few participants for a study group, or the seed is negative.
    """
    seeds.check_seed(options.seed)
    count = options.count
    if count < PEOPLE:
        raise HthorError(f"--participants {count} is too few: a group of the published study has {PEOPLE}.")
    humans = resolve_humans(options.name)
    for name in options.suites:
        tasks.load_suite(name)
    simple = () if options.quick else tuple(name for name in RIVALS if name != humans.name)
    kinds_run = kinds.names() if options.kinds else ()
    return (
        ValidationRun(word=humans.word, suite=SUITE, participants=count, role="judged"),
        *(ValidationRun(word=one, suite=SUITE, participants=min(count, _RIVAL_MOST), role="rival") for one in simple),
        *(ValidationRun(word=one, suite=SUITE, participants=min(count, _KIND_MOST), role="kind") for one in kinds_run),
        *(ValidationRun(word=humans.word, suite=one, participants=count, role="suite") for one in options.suites),
    )


def report_folder(options: ValidationOptions) -> Path:
    """The folder of the report."""
    if options.out:
        return options.out
    humans, suite = resolve_humans(options.name), tasks.load_suite(SUITE)
    what = [
        humans.sha256,
        suite.sha256,
        options.seed,
        options.count,
        rules.sha256(),
        code_identity.code_sha256([humans.model], (task.kind for task in suite.tasks)),
    ]
    return RUNS / f"validation-{humans.name}-{jsonio.sha256(what)[:10]}"


def resolve_run(options: ValidationOptions, one: ValidationRun) -> ResolvedRuns:
    """The runs of `hthor eval` that these people do, in a folder of their own."""
    suite = tasks.load_suite(one.suite)
    name = f"{resolve_humans(one.word).name}-{Path(suite.name).name}-{one.participants}"
    return resolve(
        EvalOptions(
            agent=AGENTS,
            humans=(one.word,),
            suite=one.suite,
            seed=options.seed,
            participants=one.participants,
            jobs=options.jobs,
            out=report_folder(options) / "runs" / name,
            control=False,
        )
    )


def preview_runs(options: ValidationOptions) -> Iterator[tuple[ValidationRun, RunForecast]]:
    """Each run, its progress and how long it would still take, without running or writing anything.

    Raises:
        HthorError: as in `planned_runs`.
    """
    for one in planned_runs(options):
        resolved = resolve_run(options, one)
        experiment.check_folders(resolved)
        yield from ((one, run) for run in dry_run.make_forecast(resolved, {}).runs)
