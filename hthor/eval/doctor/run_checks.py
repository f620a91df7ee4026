"""Runs all checks of the machine in one order."""

from pathlib import Path

from hthor.eval.doctor import hardware, isolation_levels, libraries, rendering, reproducibility, subprocess_probe
from hthor.eval.doctor.check_result import DoctorReport


def run_checks(runs: Path, required: str = "L1") -> DoctorReport:
    """Check everything.

    Args:
        runs: the folder that runs are to be written to; it need not be there.
        required: the least level of isolation that will do.

    Raises:
        UnknownName: when there is no such level.
    """
    isolation_levels.require_level(required)
    with (
        subprocess_probe.start_probe(rendering.__name__) as picture,
        subprocess_probe.start_probe(reproducibility.__name__) as course,
    ):
        findings = [
            *libraries.check_libraries(),
            *isolation_levels.check_isolation(required),
            *hardware.check_hardware(runs),
            *reproducibility.check_reproducibility(course.answer(reproducibility.TrialFingerprint)),
            *rendering.check_rendering(picture.answer(rendering.RenderingProbe)),
        ]
    return DoctorReport(well=all(one.status != "fail" for one in findings), findings=tuple(findings))
