"""Everything that is known, put together as the findings that a page is made of; plays and draws nothing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import msgspec
from msgspec import Struct

from hthor.calibration.pipeline.evidence import Evidence
from hthor.calibration.simulation.trial_table import Table
from hthor.calibration.targets import Targets
from hthor.calibration.validation.report import criteria, known_misfits, measures, phrases, published, study_groups
from hthor.calibration.validation.report.findings import Findings, Played, Rival, Setting, Subject
from hthor.calibration.validation.report.study_groups import Array, Groups


class Materials(Struct, frozen=True, kw_only=True, eq=False):
    """What was played on the targets' suite: the subject's trials and those of simple human models, by name.

    ``least`` is T* [s] by task, ``hands`` how many people together do every task once.
    """

    trials: Table
    least: Array
    hands: int
    rivals: Mapping[str, Table] = {}


def findings(
    subject: Subject,
    setting: Setting,
    targets: Targets,
    made: Materials,
    *,
    evidence: Evidence | None,
    evidence_missing: str = "",
    kinds: Sequence[Played] = (),
    suites: Sequence[Played] = (),
) -> Findings:
    """The whole document, gates and known misfits included."""
    study = published.of(targets)
    own = _groups(made.trials, made, targets, setting.seed)
    rivals = {name: _groups(table, made, targets, setting.seed) for name, table in made.rivals.items()}
    scored = tuple(measures.rival(name, study, made.rivals[name], made.least, drawn) for name, drawn in rivals.items())
    bare = Findings(
        subject=subject,
        setting=setting,
        published=study,
        table=measures.table(study, made.trials, made.least, own),
        spent=measures.spent(made.trials),
        differences=measures.differences(made.trials, own),
        reach=measures.reach(made.trials),
        trust=measures.trust(made.trials, own),
        own=measures.rival(subject.name, study, made.trials, made.least, own),
        rivals=scored,
        kinds=tuple(kinds),
        suites=tuple(suites),
        evidence=_with_rivals(evidence, scored),
        evidence_missing=evidence_missing,
        scope=phrases.SCOPE,
    )
    return msgspec.structs.replace(bare, gates=criteria.judge(bare), misfits=known_misfits.find(bare))


def _with_rivals(evidence: Evidence | None, scored: Sequence[Rival]) -> Evidence | None:
    """The evidence, with how well simple models foretell each condition that was left out."""
    if evidence is None:
        return None
    held_out = tuple(
        msgspec.structs.replace(
            part,
            rivals={**{one.played.name: one.log_score[part.condition] for one in scored}, **part.rivals},
        )
        for part in evidence.held_out
    )
    return msgspec.structs.replace(evidence, held_out=held_out)


def _groups(trials: Table, made: Materials, targets: Targets, seed: int) -> dict[str, Groups]:
    design = targets.design
    return study_groups.together(
        trials, made.least, hands=made.hands, valid=design.valid, counted=design.counted, seed=seed
    )
