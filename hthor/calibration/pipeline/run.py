"""`hthor calibrate` on published numbers as one function: settles what is asked for, runs the stages, keeps the result.

Parses and prints nothing.
"""

from __future__ import annotations

import os
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor.calibration import targets
from hthor.calibration.pipeline.stages import Brief, Stages, Teller
from hthor.calibration.pipeline.summary import Summary
from hthor.calibration.simulation.budget import FULL, QUICK, Sizes
from hthor.errors import HthorError, MissingExtra, UnknownName
from hthor.tasks.suites import library

CODE_ROOT = "statistics"

ROOT = Path("calibration")
SIMULATED = ("training", "studies", "correction", "predicted")
"""Stages that simulate, in order; a calibration can be told to stop after one of them."""


class CalibrationOptions(Struct, frozen=True, kw_only=True):
    """What the user asked for, None where the default holds."""

    targets: tuple[str, ...] = ("paper",)
    suite: str = "paper"
    out: Path | None = None
    seed: int = 0
    jobs: int | None = None
    sessions: int | None = None
    studies: int | None = None
    quick: bool = False
    until: str = ""


def run_calibration(options: CalibrationOptions, teller: Teller) -> Summary | None:
    """Run a calibration, or what is missing of it; None when it was told to stop before its end.

    Raises:
        MissingExtra: without scikit-learn and scipy.
        UnknownName: when there is no such target, suite or stage.
        RunError: when the folder holds simulated sessions of another world or person.
        Interrupted: on Ctrl-C or SIGTERM; what was simulated is kept.
    """
    _need_libraries()
    if options.until and options.until not in SIMULATED:
        raise UnknownName("stage", options.until, SIMULATED, "Choose one with --until, or leave it out.")
    brief = resolve_options(options)
    brief.folder.mkdir(parents=True, exist_ok=True)
    stages = Stages(brief, teller)
    if options.until:
        for name in SIMULATED[: SIMULATED.index(options.until) + 1]:
            if name != "correction" or brief.sizes.correction:
                getattr(stages, name)
        return None
    from hthor.calibration.pipeline import finalize

    return finalize.settle(stages, command(options))


def resolve_options(options: CalibrationOptions) -> Brief:
    """What is to be done, every default resolved."""
    if len(options.targets) != 1:
        raise HthorError("--target takes one set of published results, or any number of logs; not both.")
    aims, suite = targets.load(options.targets[0]), library.load_suite(options.suite)
    given = {"sessions": options.sessions, "studies": options.studies}
    sizes: Sizes = msgspec.structs.replace(
        QUICK if options.quick else FULL, **{name: value for name, value in given.items() if value is not None}
    )
    name = f"{aims.name}-{Path(suite.name).name}-{options.seed}" + ("-quick" if options.quick else "")
    return Brief(
        suite=suite,
        targets=aims,
        seed=options.seed,
        sizes=sizes,
        folder=options.out or ROOT / name,
        jobs=options.jobs or len(os.sched_getaffinity(0)),
    )


def command(options: CalibrationOptions) -> str:
    """The command that makes the same again, without where and with how many processes."""
    parts = ["hthor calibrate", *(f"--target {word}" for word in options.targets), f"--suite {options.suite}"]
    parts.append(f"--seed {options.seed}")
    numbers = {"sessions": options.sessions, "studies": options.studies}
    parts += [f"--{name} {value}" for name, value in numbers.items() if value is not None]
    return " ".join([*parts, "--quick"] if options.quick else parts)


def _need_libraries() -> None:
    try:
        import scipy
        import sklearn
    except ImportError:
        raise MissingExtra("calibration", "calibration") from None
    del scipy, sklearn


__all__ = ["CalibrationOptions", "command", "resolve_options", "run_calibration"]
