"""Writes a case study from the folders of runs: the same people at one task with several robots, as SVG and PNG."""

import io
from collections.abc import Sequence
from pathlib import Path

from hthor import jsonio
from hthor.errors import HthorError, RunError, UnknownName
from hthor.eval.records.trial_record import TrialRecord
from hthor.guest import AgentInputs
from hthor.report.analysis import load_runs
from hthor.report.analysis.load_runs import Run
from hthor.report.drawing import lettering, render_trial
from hthor.report.html import matplotlib_svg
from hthor.report.page import camera_frames, key_moments
from hthor.report.page.figures import case_study
from hthor.report.page.figures.case_study import Row

_DPI = 220


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
) -> tuple[Path, Path]:
    """Draw a task with the robots of several runs; return the paths of the SVG and of the PNG.

    Args:
        folders: of the runs. task: its id. out: the folder to write to.
        person: a participant; by default the first who did the task in every run.
        profile: how views are drawn, fast or nice.
        agents: files of agents that are not built in. humans: the human model, if its name in the log does not find it.
        given: arguments and files that the agents were given.

    Raises:
        RunError: if the runs do not belong together, or cannot be played again.
        UnknownName: if no person, or not this person, did the task in every run.
    """
    if out.exists() and not out.is_dir():
        raise HthorError(f"{out} is a file; --out takes a folder.")
    runs = load_runs.load_runs(folders)
    _same_people(runs)
    chosen = _records(runs, task, person)
    rows, house = [], render_trial.load_house(runs[0].folder, chosen[0])
    for run, record in zip(runs, chosen, strict=True):
        held = key_moments.key_moments(record, house)
        ticks = [one.tick for one in held]
        views = camera_frames.render_frames(
            run.folder, record, ticks, profile=profile, agents=agents, humans=humans, given=given
        )
        rows.append(Row(label=run.label, record=record, moments=held, views=views))
    made = case_study.case_study_figure(rows, house)
    spec = chosen[0].spec
    stem = f"case-{spec.task.id.replace('/', '-')}-{spec.session}"
    who = "One person" if len(spec.humans) == 1 else f"{len(spec.humans)} people"
    words = f"{spec.task.instruction} {who} at this task with: {', '.join(run.label for run in runs)}."
    drawn, seen = out / f"{stem}.svg", out / f"{stem}.png"
    jsonio.write(drawn, matplotlib_svg.svg_document(matplotlib_svg.to_svg(made, "case", words)).encode())
    pixels = io.BytesIO()
    with matplotlib_svg.style():
        lettering.save_figure(made, pixels, format="png", dpi=_DPI, metadata={"Software": None})
    jsonio.write(seen, pixels.getvalue())
    return drawn, seen


def _same_people(runs: Sequence[Run]) -> None:
    for one in runs[1:]:
        if one.plan.humans.sha256 != runs[0].plan.humans.sha256:
            raise RunError(
                f"{one.folder / 'run.json'}: humans.sha256 is not that of {runs[0].folder / 'run.json'}: "
                f"'{one.plan.humans.name}', not '{runs[0].plan.humans.name}'. A case shows the same people with "
                "several robots; give runs with the same people."
            )


def _records(runs: Sequence[Run], task: str, person: int | None) -> list[TrialRecord]:
    """The same people's trials of the task, one per run."""
    tables = [run.by_pair for run in runs]
    shared = sorted(pair for pair in tables[0] if all(pair in table for table in tables[1:]))
    people = {pair: [human.participant for human in tables[0][pair].spec.humans] for pair in shared}
    mine = [pair for pair in shared if pair[3] == task and (person is None or person in people[pair])]
    if mine:
        return [table[mine[0]] for table in tables]
    if person is not None and any(pair[3] == task for pair in shared):
        who = sorted({number for pair in shared if pair[3] == task for number in people[pair]})
        raise UnknownName("person", str(person), map(str, who), f"These did '{task}' in every run.")
    names = sorted({pair[3] for pair in shared})
    raise UnknownName("task", task, names, "These were done by the same people in every run.")
