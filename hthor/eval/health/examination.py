"""Everything that is looked at, in one order; judges nothing itself."""

from __future__ import annotations

from pathlib import Path

from hthor.eval.health import drawing, levels, libraries, machine, probe, sameness
from hthor.eval.health.finding import Health


def examine(runs: Path, required: str = "L1") -> Health:
    """Look at everything.

    Args:
        runs: the folder that runs are to be written to; it need not be there.
        required: the least level of isolation that will do.

    Raises:
        UnknownName: when there is no such level.
    """
    levels.check(required)
    with probe.start(drawing.__name__) as picture, probe.start(sameness.__name__) as course:
        findings = [
            *libraries.findings(),
            *levels.findings(required),
            *machine.findings(runs),
            *sameness.findings(course.answer(sameness.Course)),
            *drawing.findings(picture.answer(drawing.Drawn)),
        ]
    return Health(well=all(one.status != "fail" for one in findings), findings=tuple(findings))
