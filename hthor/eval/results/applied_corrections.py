"""The corrections that a result was made with."""

from hthor import log_corrections
from hthor.errors import RunError
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.results import result_file
from hthor.eval.results.result_file import AppliedCorrections
from hthor.log_corrections import CorrectAdoption


def applied(run: RunFolder) -> AppliedCorrections | None:
    """The corrections of a run as its result states them; None if none is in effect."""
    known = run.corrections
    if not known.in_effect:
        return None
    return AppliedCorrections(
        voided=run.given_up,
        repeated=len(known.repeated),
        adoptions=sum(isinstance(line, CorrectAdoption) for line in known.in_effect),
        lines=len(known.lines),
        sha256=known.hashes[-1],
    )


def check_kept(run: RunFolder) -> None:
    """Check that every line of corrections with which the run was scored is still there.

    Raises:
        RunError: when lines at the end of the file, or the whole file, are gone.
    """
    stored = result_file.load_current(run.path)
    if stored is None or not stored.corrections:
        return
    before, now = stored.corrections, run.corrections
    if now.hashes[before.lines - 1 : before.lines] != (before.sha256,):
        raise RunError(
            f"{run.path / log_corrections.NAME} has {len(now.lines)} lines, and is not a continuation of the "
            f"{before.lines} with which {run.result_file.name} was made. Corrections are withdrawn by another line, "
            "and never deleted: take the file from a copy of the run, or delete "
            f"{run.result_file.name} to score without them."
        )
