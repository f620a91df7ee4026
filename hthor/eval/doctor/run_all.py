"""Everything that is looked at, in one order; judges nothing itself."""

from __future__ import annotations

from pathlib import Path

from hthor.eval.doctor import hardware, isolation_levels, libraries, rendering, reproducibility, subprocess_probe
from hthor.eval.doctor.result import DoctorReport


def run_all(runs: Path, required: str = "L1") -> DoctorReport:
    """Look at everything.

    Args:
        runs: the folder that runs are to be written to; it need not be there.
        required: the least level of isolation that will do.

    Raises:
        UnknownName: when there is no such level.
    """
    isolation_levels.check(required)
    with (
        subprocess_probe.start(rendering.__name__) as picture,
        subprocess_probe.start(reproducibility.__name__) as course,
    ):
        findings = [
            *libraries.findings(),
            *isolation_levels.findings(required),
            *hardware.findings(runs),
            *reproducibility.findings(course.answer(reproducibility.Course)),
            *rendering.findings(picture.answer(rendering.Drawn)),
        ]
    return DoctorReport(well=all(one.status != "fail" for one in findings), findings=tuple(findings))
