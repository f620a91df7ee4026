"""The published study as the report shows it, from the targets that models are fitted to."""

from __future__ import annotations

from hthor.calibration.pipeline.evidence import FIGURES
from hthor.calibration.targets import Targets
from hthor.calibration.validation.report.findings import Count, Published


def of(targets: Targets) -> Published:
    """Counts, ratios and words of a published study."""
    counts = [
        (f"{metric} {name}", one) for metric in ("sr", "adoption") for name, one in getattr(targets, metric).items()
    ]
    return Published(
        name=targets.name,
        source=targets.source,
        sha256=targets.sha256,
        counts=tuple(
            Count(figure=figure, k=one.k, n=one.n, inferred=one.inferred, note=one.note) for figure, one in counts
        ),
        ratio=dict(targets.ratio),
        verbal=tuple((one.name, one.says) for one in targets.verbal),
        figures={name: round(targets.published[name] / 100.0, 6) for name in FIGURES if name in targets.published},
        design=targets.design.note,
    )
