"""The findings of a validation, computed from the runs' records, the targets and the evidence."""

from collections.abc import Mapping, Sequence

import msgspec
import numpy as np
from msgspec import Struct

from hthor.calibration.evidence import FIGURES, Evidence
from hthor.calibration.simulation import trial_table
from hthor.calibration.simulation.session_simulation import OUTCOMES, outcome_row
from hthor.calibration.simulation.trial_table import Table
from hthor.calibration.targets import CONDITIONS, Targets
from hthor.calibration.validation.report import criteria, measures, phrases, study_groups
from hthor.calibration.validation.report.findings import (
    Findings,
    ModelFigures,
    ModelScore,
    ModelUnderTest,
    PublishedCount,
    PublishedStudy,
    Setting,
)
from hthor.calibration.validation.report.study_groups import Array, StudyGroups
from hthor.eval.records.trial_record import TrialRecord
from hthor.tasks import Suite


class PlayedTrials(Struct, frozen=True, kw_only=True, eq=False):
    """Trials on the targets' suite by the model under test, and by simple human models (``rivals``, by name).

    ``t_star`` is T* [s] by task; ``round_size`` people together do every task once.
    """

    trials: Table
    t_star: Array
    round_size: int
    rivals: Mapping[str, Table] = {}


def make_findings(
    subject: ModelUnderTest,
    setting: Setting,
    targets: Targets,
    played: PlayedTrials,
    *,
    evidence: Evidence | None,
    evidence_missing: str = "",
    kinds: Sequence[ModelFigures] = (),
    suites: Sequence[ModelFigures] = (),
) -> Findings:
    """The whole document, including gates and known misfits."""
    study = published_study(targets)
    own = _groups(played.trials, played, targets, setting.seed)
    rivals = {name: _groups(table, played, targets, setting.seed) for name, table in played.rivals.items()}
    scored = tuple(
        measures.score_model(name, study, played.rivals[name], played.t_star, drawn) for name, drawn in rivals.items()
    )
    bare = Findings(
        subject=subject,
        setting=setting,
        published=study,
        table=measures.predict_figures(study, played.trials, played.t_star, own),
        spent=measures.time_spent(played.trials),
        differences=measures.time_differences(played.trials, own),
        reach=measures.message_reach(played.trials),
        trust=measures.trust_findings(played.trials, own),
        own=measures.score_model(subject.name, study, played.trials, played.t_star, own),
        rivals=scored,
        kinds=tuple(kinds),
        suites=tuple(suites),
        evidence=_with_rivals(evidence, scored),
        evidence_missing=evidence_missing,
        scope=phrases.SCOPE,
    )
    return msgspec.structs.replace(bare, gates=criteria.judge_findings(bare), misfits=criteria.find_misfits(bare))


def _with_rivals(evidence: Evidence | None, scored: Sequence[ModelScore]) -> Evidence | None:
    """The evidence, with the log scores of simple models for each condition that was left out."""
    if evidence is None:
        return None
    held_out = tuple(
        msgspec.structs.replace(
            part, rivals={**{one.played.name: one.log_score[part.condition] for one in scored}, **part.rivals}
        )
        for part in evidence.held_out
    )
    return msgspec.structs.replace(evidence, held_out=held_out)


def _groups(trials: Table, played: PlayedTrials, targets: Targets, seed: int) -> dict[str, StudyGroups]:
    design = targets.design
    return study_groups.make_groups(
        trials, played.t_star, round_size=played.round_size, valid=design.valid, counted=design.counted, seed=seed
    )


def published_study(targets: Targets) -> PublishedStudy:
    """The published study as the report shows it, from the targets."""
    return PublishedStudy(
        name=targets.name,
        source=targets.source,
        sha256=targets.sha256,
        counts=tuple(
            PublishedCount(figure=f"{metric} {name}", **msgspec.structs.asdict(count))
            for metric in ("sr", "adoption")
            for name, count in getattr(targets, metric).items()
        ),
        ratio=dict(targets.ratio),
        verbal=tuple((one.name, one.says) for one in targets.verbal),
        figures={name: round(targets.published[name] / 100.0, 6) for name in FIGURES if name in targets.published},
        design=targets.design.note,
    )


def records_table(runs: dict[str, Sequence[TrialRecord]], suite: Suite) -> Table:
    """The trials of one human model, from its records by condition."""
    numbers = {task.id: number for number, task in enumerate(suite.tasks)}
    rows = [_row(condition, numbers, record) for condition in CONDITIONS for record in runs.get(condition, ())]
    columns = {name: [row[name] for row in rows] for name in trial_table.COLUMNS}
    return trial_table.build_table(("none",), np.zeros((1, 1)), columns)


def _row(condition: str, numbers: dict[str, int], record: TrialRecord) -> dict[str, int]:
    spec, number = record.spec, CONDITIONS.index(condition)
    outcomes = dict(zip(OUTCOMES, outcome_row(numbers[spec.task.id], spec, record.log), strict=True))
    return {
        **outcomes,
        "study": -1,
        "session": number * 100_000 + spec.session,
        "point": 0,
        "condition": number,
        "participant": spec.session,
        "index": spec.index,
        "trust": outcomes["trust"] if spec.robots else 0,
        "valid": 1,
        "counted": int(bool(spec.robots)),
    }
