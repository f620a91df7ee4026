"""Checks a board's entries: their form, schema and spelling, and the rules of `invariants`."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from msgspec import UNSET, Struct

from hthor import jsonio, tasks
from hthor.errors import HthorError
from hthor.eval.metrics.metric import mean_limit
from hthor.guest.agent import manifest
from hthor.leaderboard import schema
from hthor.leaderboard.entries import files, invariants, trial_outcomes
from hthor.leaderboard.entries.entry import Entry
from hthor.leaderboard.entries.files import BoardError, Problem
from hthor.leaderboard.entries.trial_outcomes import Outcomes, Unreadable
from hthor.leaderboard.ranking import admission, listing
from hthor.leaderboard.ranking.admission import Admission
from hthor.leaderboard.submission import submission
from hthor.tasks.suites import library
from hthor.types import TaskSpec

SPELLING = "$ (canonical form)"
"""The field that a problem names if only the spelling is wrong."""


class _Held(Struct, frozen=True, kw_only=True):
    """An entry that can be read, and its columns of outcomes."""

    path: Path
    entry: Entry
    outcomes: Outcomes


def check_board(board: Path, paths: Sequence[Path] = (), *, submissions: Path | None = None) -> list[Problem]:
    """Every problem of these entries, or of all entries of the board if ``paths`` is empty.

    Args:
        board: its other entries are searched for controls. submissions: folder of the agents' files, if there is one.
    """
    found: list[Problem] = []
    wanted = list(paths) or files.entry_paths(files.check_folder(board))
    others = [path for path in files.entry_paths(board) if path.resolve() not in {one.resolve() for one in wanted}]
    held, trusted = [], []
    for path in wanted:
        wrong = list(form_problems(path))
        found += wrong
        held += [] if any(one.field != SPELLING for one in wrong) else list(_read(path, found))
    for path in others:  # these are not checked here; a file that cannot be read cannot be a control
        trusted += list(_read(path, []))
    sizes = {one: made.tasks for one, made in files.read_commitments(board).items()}
    taken = admission.load_admission(board)
    for one in held:
        laws = _laws(one, (*held, *trusted), sizes, taken, submissions)
        found += [Problem(file=str(one.path), field=field, problem=problem) for field, problem in laws]
    return found


def _read(path: Path, found: list[Problem]) -> Iterator[_Held]:
    try:
        entry = files.read_form(path)
        yield _Held(path=path, entry=entry, outcomes=trial_outcomes.unpack(entry.trials))
    except Unreadable as error:
        found.append(Problem(file=str(path), field=f"trials.{error.field}", problem=str(error)))
    except HthorError as error:
        found.append(Problem(file=str(path), field="$", problem=str(error)))


def _laws(
    one: _Held, all_: Sequence[_Held], sizes: dict[str, int], taken: Admission, submissions: Path | None
) -> invariants.Problems:
    entry, held = one.entry, one.outcomes
    yield from invariants.check_hashes(entry, held)
    yield from invariants.check_sizes(entry, held)
    yield from admission.admission_problems(entry, taken)
    yield from _suite(entry, sizes)
    yield from invariants.check_outcomes(entry, held, _tasks(entry))
    yield from invariants.check_settings(entry)
    yield from invariants.check_agents(entry)
    yield from invariants.check_metrics(entry, held)
    control = next((other for other in all_ if _controls(other.entry, entry)), None)
    yield from invariants.check_uplift(
        entry, held, control.entry if control else None, control.outcomes if control else None
    )
    if entry.submission and submissions is not None:
        yield from _submitted(entry, submissions / entry.submission)


def _controls(other: Entry, entry: Entry) -> bool:
    """Whether the other entry is the control of the entry's uplift: the same trials, without a robot."""
    named = entry.uplift is not None and entry.uplift.control == other.hashes.run
    return (
        named
        and other.alone
        and listing.comparison_key(other)[:5] == listing.comparison_key(entry)[:5]
        and _code(other) == _code(entry)
    )


def _code(entry: Entry) -> tuple[str, str]:
    return entry.run.code_sha256, entry.run.rules_sha256


def _suite(entry: Entry, sizes: dict[str, int]) -> invariants.Problems:
    """The suite is hthor's own or has a commitment on the board, and the run has all of its tasks."""
    suite = entry.run.suite
    if suite.name in tasks.suite_names():
        ours = library.read_suite(suite.name)
        same = ours.sha256 == suite.sha256
        count = len(ours.tasks) if same else entry.run.trials
        limit_s = mean_limit([one.time_limit for one in ours.tasks])
        if same and entry.trials.time_limit_s not in (UNSET, limit_s):
            yield "trials.time_limit_s", f"is {entry.trials.time_limit_s}, but that of the suite is {limit_s}"
    elif suite.sha256 in sizes:
        count = sizes[suite.sha256]
    else:
        yield "run.suite.sha256", "belongs to no suite of hthor, and to none that is committed to in suites/"
        return
    if entry.run.trials != count:
        yield "run.trials", f"is {entry.run.trials}, but the suite has {count} tasks"


def _tasks(entry: Entry) -> list[TaskSpec]:
    """The task of each trial if the suite is hthor's own in its current version; else empty, as for a secret suite."""
    if entry.run.suite.name not in tasks.suite_names():
        return []
    ours = library.read_suite(entry.run.suite.name)
    return trial_outcomes.tasks_of_trials(ours, entry) if ours.sha256 == entry.run.suite.sha256 else []


def _submitted(entry: Entry, folder: Path) -> invariants.Problems:
    """The entry's list of submitted files agrees with the folder."""
    if not folder.is_dir():
        yield "submission", f"is '{entry.submission}', but there is no {folder}"
    elif found := manifest.differences(entry.files, submission.list_files(folder)):
        yield "files", f"is not what lies in {folder}: {'; '.join(found)}"


def form_problems(path: Path) -> Iterator[Problem]:
    """Problems of the form of an entry's file."""
    try:
        entry = files.read_form(path)
    except BoardError as error:
        field, _, problem = str(error).removeprefix(f"{path}: ").partition(": ")
        yield Problem(file=str(path), field=field, problem=problem)
        return
    wrong = list(_strictly(path, entry))
    yield from wrong
    if wrong:
        return
    if entry.id != path.stem:
        yield Problem(file=str(path), field="id", problem=f"is '{entry.id}', but must be the file's, '{path.stem}'")
    if jsonio.pretty(entry) != path.read_bytes():
        how = "sorted keys, two spaces, a newline at the end; 'hthor leaderboard validate --fix' writes that"
        yield Problem(file=str(path), field=SPELLING, problem=f"is not {how}")


def fix_forms(paths: Sequence[Path]) -> list[Path]:
    """Rewrite valid files that are not in canonical form; return their paths."""
    fixed = []
    for path in paths:
        try:
            entry = files.read_form(path)
        except BoardError:
            continue
        if not list(_strictly(path, entry)) and jsonio.pretty(entry) != path.read_bytes():
            files.write_document(path, entry)
            fixed.append(path)
    return fixed


def _strictly(path: Path, entry: Entry) -> Iterator[Problem]:
    """Violations of the schema's rules that the types of the fields do not express."""
    for field, problem in schema.schema_problems(path.read_bytes(), entry):
        yield Problem(file=str(path), field=field, problem=problem)
