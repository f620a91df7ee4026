"""`hthor humans validate` as one function: plays people on the published study's tasks and sets them against it.

Any people will do: a population, a kind of people, a human model in a file. Parses and prints nothing.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path

from msgspec import Struct

from hthor import jsonio, rules, tasks
from hthor.calibration import table as tables
from hthor.calibration import targets
from hthor.calibration.report import assemble, evidence, measures, page, trials
from hthor.calibration.report.document import Findings, Played, Setting, Subject
from hthor.calibration.report.evidence import Evidence
from hthor.calibration.report.groups import PEOPLE
from hthor.calibration.table import AGENTS, CONDITIONS, Table
from hthor.errors import HthorError
from hthor.eval import campaign, intent, peoples, provenance, reading
from hthor.eval.campaign import ClosableWatcher
from hthor.eval.intent import RUNS
from hthor.eval.record import Record
from hthor.eval.session import people_for
from hthor.humans import kinds, people
from hthor.humans.people import PROXY, People
from hthor.tasks import Suite

SUITE = TARGETS = "paper"
QUICK = 12
"""Participants in each condition of a quick run, at most: two study groups, enough to see that all works."""
JUDGED = 18
"""Participants in each condition from which on there are enough different groups for a verdict."""
RIVALS = peoples.EXTREMES
_RIVAL_MOST, _KIND_MOST = 30, 20
"""Participants in each condition of a simple model, and of each kind of people, at most."""
OTHERS = "The evidence at hand is of another population than these people's."
_SHIPPED = Path(__file__).parent / "evidence"


class Options(Struct, frozen=True, kw_only=True):
    """What the user asked for.

    Attributes:
        name: as `hthor.humans.people.find` reads it.
        calibration: folder of the calibration that these people come from; None for what ships with them.
        suites: other suites to rank the robots on. kinds: whether every kind of people is played too.
        quick: few people and no simple models; what is played is then not judged.
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


class Outcome(Struct, frozen=True, kw_only=True):
    """What was found, and the folder with `validation.html` and `validation.json`."""

    findings: Findings
    folder: Path


Watch = Callable[[str], ClosableWatcher]


def conduct(options: Options, watcher: Watch) -> Outcome:
    """Play what is missing, work out everything, and write the report.

    Args:
        watcher: makes who follows the run of this name.

    Raises:
        UnknownName: when there are no such people, or no such suite.
        HthorError: when there are too few participants for a study group.
        RunError: when a run's folder holds another run, or the calibration's folder no evidence.
    """
    count = min(QUICK, options.participants) if options.quick else options.participants
    if count < PEOPLE:
        raise HthorError(f"--participants {count} is too few: a group of the published study has {PEOPLE}.")
    found, suite = people.find(options.name), tasks.suite(SUITE)
    others = [tasks.suite(name) for name in options.suites]
    known, missing = _evidence(found, options.calibration)
    folder = options.out or RUNS / _folder_name(found, suite, options, count)
    stage = _Stage(options, folder, watcher)
    own = stage.play(found.word, suite, count)
    rivals = () if options.quick else tuple(name for name in RIVALS if name != found.name)
    made = assemble.Materials(
        trials=own,
        least=tables.t_star(suite),
        hands=people_for(len(suite.tasks)),
        rivals={name: stage.play(name, suite, min(count, _RIVAL_MOST)) for name in rivals},
    )
    findings = assemble.findings(
        _subject(found, stage.notes),
        _setting(suite, options, count, len(own)),
        targets.load(TARGETS),
        made,
        evidence=known,
        evidence_missing=missing,
        kinds=_kinds(stage, suite, min(count, _KIND_MOST)) if options.kinds else (),
        suites=[measures.played(one.name, stage.play(found.word, one, count), tables.t_star(one)) for one in others],
    )
    jsonio.write(folder / "validation.json", jsonio.pretty(findings))
    jsonio.write(folder / "validation.html", page.render(findings).encode())
    return Outcome(findings=findings, folder=folder)


class _Stage:
    """Plays people in all three conditions, each run in a folder of its own."""

    def __init__(self, options: Options, folder: Path, watcher: Watch) -> None:
        self._options, self._folder, self._watcher = options, folder, watcher
        self._words = {tasks.suite(word).sha256: word for word in options.suites}
        self.notes: tuple[str, ...] = ()
        """What is known to be unlike the people's calibration, of those that were played first."""

    def play(self, word: str, suite: Suite, participants: int) -> Table:
        """The trials of some people on a suite, in every condition."""
        name = people.find(word).name
        asked = intent.Options(
            agents=AGENTS,
            humans=(word,),
            suite=SUITE if suite.name == SUITE else self._words[suite.sha256],
            seed=self._options.seed,
            participants=participants,
            jobs=self._options.jobs or len(os.sched_getaffinity(0)),
            out=self._folder / "runs" / f"{name}-{Path(suite.name).name}-{participants}",
        )
        runs: dict[str, Sequence[Record]] = {}
        for done in campaign.conduct(asked, lambda title: self._watcher(f"{name} people, {title}")):
            condition = CONDITIONS[AGENTS.index(done.plan.name)]
            runs[condition] = reading.records(done.folder, done.plan)[1]
            self.notes = self.notes or done.plan.humans.notes
        return trials.table(runs, suite)


def _kinds(stage: _Stage, suite: Suite, participants: int) -> Sequence[Played]:
    least = tables.t_star(suite)
    return [measures.played(name, stage.play(name, suite, participants), least) for name in kinds.names()]


def _subject(found: People, notes: Sequence[str]) -> Subject:
    return Subject(
        name=found.name,
        model=Path(found.model).name,
        sha256=found.sha256,
        population=found.population.name,
        population_sha256=found.population.sha256,
        purpose=found.purpose,
        notes=tuple(f"{note[:1].upper()}{note[1:]}." for note in notes),
    )


def _setting(suite: Suite, options: Options, count: int, trials: int) -> Setting:
    return Setting(
        suite=suite.name,
        suite_sha256=suite.sha256,
        simulation=rules.SIMULATION,
        seed=options.seed,
        participants=count,
        trials=trials,
        code_sha256=provenance.code_sha256(),
        versions=provenance.versions(),
        quick=options.quick or count < JUDGED,
    )


def _evidence(found: People, folder: Path | None) -> tuple[Evidence | None, str]:
    """What the calibration of these people found out; otherwise a sentence that says why there is nothing."""
    if folder is not None:
        known = evidence.load(folder)
    elif found.model != PROXY:
        return None, "This human model was not calibrated, so nothing is known of a fit."
    elif found.kind is not None:
        return None, "This kind of people is made out of a population by hand and was not calibrated itself."
    elif (file := _file_of(found)) is not None:
        known = evidence.load(file)
    elif not found.population.validity.targets_sha256:
        return None, "This population was fitted to no data: it is the literature's."
    else:
        return None, "The evidence of this population's calibration is not at hand; name its folder with --calibration."
    if known.origin.population_sha256 != found.population.sha256:
        return None, OTHERS
    return known, ""


def _file_of(found: People) -> Path | None:
    """The evidence that lies beside a population's file, or ships with a population of ours."""
    beside = Path(found.word).parent / evidence.FILE
    if found.word.endswith((".npz", ".json")) and beside.is_file():
        return beside
    shipped = _SHIPPED / f"{found.population.name}.json"
    return shipped if shipped.is_file() else None


def _folder_name(found: People, suite: Suite, options: Options, count: int) -> str:
    what = [found.sha256, suite.sha256, options.seed, count, rules.sha256(), provenance.code_sha256()]
    return f"validation-{found.name}-{jsonio.sha256(what)[:10]}"
