"""`hthor calibrate` on published numbers as one function: runs the stages and writes the result."""

import importlib

from hthor.calibration.pipeline import finalize
from hthor.calibration.pipeline.config import CalibrationOptions, reproducing_command, resolve_options
from hthor.calibration.pipeline.stages import CalibrationStages, ProgressReporter
from hthor.calibration.pipeline.summary import CalibrationSummary
from hthor.errors import MissingExtra, UnknownName

CODE_ROOT = "statistics"

SIMULATED = ("training", "studies", "correction", "predicted")
"""Stages that simulate, in order; a calibration can be told to stop after one of them."""


def run_calibration(options: CalibrationOptions, progress: ProgressReporter) -> CalibrationSummary | None:
    """Run a calibration, or what is missing of it; None when it was told to stop before its end.

    Raises:
        MissingExtra: without scikit-learn.
        UnknownName: when there is no such target, suite or stage.
        RunError: when the folder holds sessions simulated in another world or with another human model.
        Interrupted: on Ctrl-C or SIGTERM; what was simulated is kept.
    """
    _require_libraries()
    if options.until and options.until not in SIMULATED:
        raise UnknownName("stage", options.until, SIMULATED, "Choose one with --until, or leave it out.")
    config = resolve_options(options)
    config.folder.mkdir(parents=True, exist_ok=True)
    stages = CalibrationStages(config, progress)
    if options.until:
        for name in SIMULATED[: SIMULATED.index(options.until) + 1]:
            if name != "correction" or config.sizes.correction:
                getattr(stages, name)
        return None
    return finalize.write_results(stages, reproducing_command(options))


def _require_libraries() -> None:
    """Fail before anything is simulated rather than after."""
    for name in ("sklearn", "threadpoolctl"):
        try:
            importlib.import_module(name)
        except ImportError:
            raise MissingExtra("calibration", "calibration") from None
