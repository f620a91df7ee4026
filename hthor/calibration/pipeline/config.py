"""The settings of a calibration: the user's options, and the configuration that follows from them."""

import os
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor import seeds
from hthor.calibration import targets
from hthor.calibration.targets import Targets
from hthor.errors import HthorError
from hthor.tasks import Suite
from hthor.tasks.suites import library

ROOT = Path("calibration")


class CalibrationSizes(Struct, frozen=True, kw_only=True):
    """Numbers of sessions of ten trials, of whole studies, and of draws.

    Attributes:
        sessions: number of sessions spread over the prior, to train the emulator.
        correction: number of sessions near the first posterior, for a second training; 0 for none.
        studies: number of studies at points of the prior, for coverage, design effects and the ABC check.
        posterior_studies: number of studies at draws of the posterior, to see what people of the population do.
        members: number of networks in the emulator's ensemble.
        draws: number of draws of the population. proposals: number of points of the importance sampling.
        quick: whether this is the small calibration, which only shows that everything works; do not use its results.
    """

    sessions: int = 4000
    correction: int = 1000
    studies: int = 200
    posterior_studies: int = 60
    members: int = 6
    draws: int = 1000
    proposals: int = 1 << 18
    quick: bool = False


FULL = CalibrationSizes()
QUICK = CalibrationSizes(
    sessions=120, correction=0, studies=10, posterior_studies=1, members=4, draws=400, proposals=1 << 14, quick=True
)


class CalibrationOptions(Struct, frozen=True, kw_only=True):
    """The user's options; None means the default."""

    targets: tuple[str, ...] = ("paper",)
    suite: str = "paper"
    out: Path | None = None
    seed: int = 0
    jobs: int | None = None
    sessions: int | None = None
    studies: int | None = None
    quick: bool = False
    until: str = ""


class CalibrationConfig(Struct, frozen=True, kw_only=True):
    """A calibration with every default resolved; ``folder`` is for all files, ``jobs`` counts worker processes."""

    suite: Suite
    targets: Targets
    seed: int
    sizes: CalibrationSizes
    folder: Path
    jobs: int


def resolve_options(options: CalibrationOptions) -> CalibrationConfig:
    """The configuration that follows from the options.

    Raises:
        UnknownName: when there is no such target or suite.
        HthorError: when the targets are not one set of published results, or the seed is negative.
    """
    seeds.check_seed(options.seed)
    if len(options.targets) != 1:
        raise HthorError("--target takes one set of published results, or any number of logs; not both.")
    published, suite = targets.load_targets(options.targets[0]), library.load_suite(options.suite)
    name = f"{published.name}-{Path(suite.name).name}-{options.seed}" + ("-quick" if options.quick else "")
    return CalibrationConfig(
        suite=suite,
        targets=published,
        seed=options.seed,
        sizes=msgspec.structs.replace(QUICK if options.quick else FULL, **_given_sizes(options)),
        folder=options.out or ROOT / name,
        jobs=options.jobs or len(os.sched_getaffinity(0)),
    )


def reproducing_command(options: CalibrationOptions) -> str:
    """The command that makes the same population again; the folder and the number of processes are left out."""
    parts = ["hthor calibrate", *(f"--target {word}" for word in options.targets), f"--suite {options.suite}"]
    parts.append(f"--seed {options.seed}")
    parts += [f"--{name} {value}" for name, value in _given_sizes(options).items()]
    return " ".join([*parts, "--quick"] if options.quick else parts)


def _given_sizes(options: CalibrationOptions) -> dict[str, int]:
    sizes = {"sessions": options.sessions, "studies": options.studies}
    return {name: value for name, value in sizes.items() if value is not None}
