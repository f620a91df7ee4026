"""Draws a logged trial as a picture or a video in a file."""

from pathlib import Path

from hthor.errors import HthorError
from hthor.eval.records.trial_record import TrialRecord
from hthor.houses import HouseLibrary
from hthor.report.drawing import figure_file
from hthor.types import HouseSpec

VIDEOS = (".webm",)
"""Endings of the files that a video can be written to."""


def draw_trial(run: Path, record: TrialRecord, path: Path, *, video: bool) -> None:
    """Write the picture or the video of a trial of the run in the folder ``run``.

    Raises:
        HthorError: if the file's name has the wrong ending, or the house has changed since the trial.
    """
    check_file_name(path, video=video)
    plan = load_house(run, record)
    path.parent.mkdir(parents=True, exist_ok=True)
    if video:
        from hthor.report.drawing import trial_video as film

        film.write_video(path, record.spec, record.log, plan)
    else:
        from hthor.report.drawing import trial_figure

        figure_file.write_figure(trial_figure.trial_figure(record.spec, record.log, plan), path)


def check_file_name(path: Path, *, video: bool) -> None:
    """Check that a file's name has the ending of a picture or of a video.

    Raises:
        HthorError: if it has another ending.
    """
    if video:
        figure_file.check_suffix(path, VIDEOS, "video")
    else:
        figure_file.check_name(path)


def load_house(run: Path, record: TrialRecord) -> HouseSpec:
    """The house of a trial of the run in the folder ``run``, as it was in the trial.

    Raises:
        HthorError: if the house has changed since the trial.
    """
    task = record.spec.task
    found = HouseLibrary(folder=run / "houses").load(task.house)
    if found.sha256 != task.house_sha256:
        raise HthorError(
            f"the house '{task.house}' has changed since this trial was played (its hash was {task.house_sha256[:10]} "
            f"and is {found.sha256[:10]}); a picture of it would be wrong."
        )
    return found
