"""Writes a case study from the folders of runs: the same people at one task with several robots, as a figure."""

from collections.abc import Sequence
from pathlib import Path

from matplotlib.figure import Figure

from hthor import jsonio
from hthor.errors import HthorError, RunError, UnknownName
from hthor.eval.records.scored_trial import ScoredTrial
from hthor.eval.results import group_difference
from hthor.guest import AgentInputs
from hthor.report.analysis import load_runs
from hthor.report.analysis.load_runs import Run
from hthor.report.drawing import figure_file, render_trial
from hthor.report.html import matplotlib_svg
from hthor.report.page import camera_frames, key_moments
from hthor.report.page.figures import case_study
from hthor.report.page.figures.case_study import Row

_DPI = 220
_OTHER_PICTURES = (".jpg", ".jpeg", ".gif", ".eps", ".ps", ".tif", ".tiff", ".webp", ".bmp")
"""Endings of pictures that are not written; no folder is called like this."""


def write_case_study(
    folders: Sequence[Path],
    task: str,
    out: Path,
    *,
    person: int | None = None,
    profile: str = "fast",
    agents: Sequence[str] = (),
    humans: str = "",
    given: AgentInputs | None = None,
) -> tuple[Path, ...]:
    """Draw a task with the robots of several runs; return the files that were written.

    Args:
        folders: of the runs. task: its id.
        out: the file to write, .png, .svg or .pdf, or a folder for an SVG and a PNG.
        person: a participant; by default the first who did the task in every run.
        profile: how views are drawn, fast or nice.
        agents: files of agents that are not built in. humans: the human model, if its name in the log does not find it.
        given: arguments and files that the agents were given.

    Raises:
        RunError: if the runs do not belong together, or cannot be played again.
        UnknownName: if no person, or not this person, did the task in every run.
    """
    one = out.suffix.lower() in (*figure_file.SUFFIXES, *_OTHER_PICTURES) and not out.is_dir()
    if one:
        figure_file.check_name(out)
    elif out.exists() and not out.is_dir():
        raise HthorError(f"{out} is a file; --out takes a folder, or a file that ends in .png, .svg or .pdf.")
    runs = load_runs.load_runs(folders)
    _same_people(runs)
    chosen = _records(runs, task, person)
    rows, house = [], render_trial.load_house(runs[0].folder, chosen[0])
    for run, record in zip(runs, chosen, strict=True):
        held = key_moments.key_moments(record, house)
        ticks = [one.tick for one in held]
        seen = camera_frames.render_frames(
            run.folder, record, ticks, profile=profile, agents=agents, humans=humans, given=given
        )
        rows.append(Row(label=run.label, record=record, moments=held, seen=seen))
    made = case_study.case_study_figure(rows, house)
    spec = chosen[0].spec
    stem = f"case-{spec.task.id.replace('/', '-')}-{spec.session}"
    who = "One person" if len(spec.humans) == 1 else f"{len(spec.humans)} people"
    words = f"{spec.task.instruction} {who} at this task with: {', '.join(run.label for run in runs)}."
    paths = (out,) if one else (out / f"{stem}.svg", out / f"{stem}.png")
    for path in paths:
        _write(made, path, words)
    return paths


def _write(made: Figure, path: Path, words: str) -> None:
    """Write the figure; ``words`` describe it for people who cannot see it."""
    if path.suffix.lower() == ".svg":
        jsonio.write(path, matplotlib_svg.svg_document(matplotlib_svg.to_svg(made, "case", words)).encode())
        return
    with matplotlib_svg.style():
        figure_file.write_figure(made, path, dpi=_DPI)


def _same_people(runs: Sequence[Run]) -> None:
    for one in runs[1:]:
        if group_difference.are_groups(runs[0].plan, one.plan):
            raise RunError(
                f"{runs[0].folder} and {one.folder} are groups of a between-subjects study, and nobody was in both. A "
                "case shows the same people with several robots; give one of the runs."
            )
        if one.plan.humans.sha256 != runs[0].plan.humans.sha256:
            raise RunError(
                f"{one.folder / 'run.json'}: humans.sha256 is not that of {runs[0].folder / 'run.json'}: "
                f"'{one.plan.humans.name}', not '{runs[0].plan.humans.name}'. A case shows the same people with "
                "several robots; give runs with the same people."
            )


def _records(runs: Sequence[Run], task: str, person: int | None) -> list[ScoredTrial]:
    """The same people's trials of the task, one per run."""
    tables = [run.by_pair for run in runs]
    shared = sorted(pair for pair in tables[0] if all(pair in table for table in tables[1:]))
    people = {pair: [human.participant for human in tables[0][pair].spec.humans] for pair in shared}
    mine = [pair for pair in shared if pair[3] == task and (person is None or person in people[pair])]
    if mine:
        return [table[mine[0]] for table in tables]
    void = next(((run, one) for run in runs for one in run.voided if one.task == task), None)
    if void is not None:
        raise RunError(
            f"{void[0].folder}: trial {void[1].key} of '{task}' is void and shows nothing about the robot: "
            f"{void[1].reason}. 'hthor replay {void[0].folder} {void[1].key}' draws it all the same."
        )
    if person is not None and any(pair[3] == task for pair in shared):
        who = sorted({number for pair in shared if pair[3] == task for number in people[pair]})
        raise UnknownName("person", str(person), map(str, who), f"These did '{task}' in every run.")
    names = sorted({pair[3] for pair in shared})
    raise UnknownName("task", task, names, "These were done by the same people in every run.")
