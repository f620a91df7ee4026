"""Published results of people, as counts to fit a model to.

A target file gives the number of trials behind each number, because percentages hide it, and marks numbers that were
inferred or only stated in words. Our own targets are in this folder.
"""

from __future__ import annotations

from pathlib import Path

from msgspec import Struct

from hthor import documents, jsonio
from hthor.errors import HthorError, UnknownName

SCHEMA = "hthor.targets/1"
CONDITIONS = ("none", "frontier", "oracle")
_FOLDER = Path(__file__).parent
_RATIO_STEP = 0.002
"""Largest difference between a ratio and the quotient of the published percentages, which have three digits."""


class Count(Struct, frozen=True, kw_only=True):
    """``k`` of ``n`` trials; ``inferred`` when the study does not print them; ``note`` says how they were found."""

    k: int
    n: int
    inferred: bool = False
    note: str = ""

    @property
    def share(self) -> float:
        """k / n."""
        return self.k / self.n


class VerbalFinding(Struct, frozen=True, kw_only=True):
    """A finding stated in words; ``fitted``: the fit may use it, otherwise it is only checked."""

    name: str
    says: str
    fitted: bool = False


class Design(Struct, frozen=True, kw_only=True):
    """How the study was made: ``people`` in each condition, with ``tasks`` each.

    Of its trials ``valid`` count in the success rate of a condition, ``counted`` in its adoption rate.
    """

    people: int
    tasks: int
    valid: dict[str, int]
    counted: dict[str, int]
    note: str = ""


class Targets(Struct, frozen=True, kw_only=True):
    """Published numbers by condition: "none", "frontier", "oracle". Numbers that a study does not report are absent.

    Attributes:
        sr: counts of successes. adoption: counts of trials with an accepted message.
        ratio: TWSR / SR: mean of T*/max(T*, T) over the successes.
        published: the percentages as printed, by name such as "sr none".
        left_out: always empty; a part of the hash that populations refer to.
    """

    schema: str
    name: str
    source: str
    design: Design
    sr: dict[str, Count]
    adoption: dict[str, Count]
    ratio: dict[str, float]
    published: dict[str, float]
    verbal: tuple[VerbalFinding, ...] = ()
    left_out: str = ""

    @property
    def sha256(self) -> str:
        """Hash of all fields."""
        return jsonio.sha256(self)


def target_names() -> tuple[str, ...]:
    """Names of the targets that come with hthor."""
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.json")))


def load_targets(name_or_path: str | Path) -> Targets:
    """Targets by name, or from a file of the same form.

    Raises:
        UnknownName: when no targets have that name.
        HthorError: when the file cannot be read or contradicts itself; names file and field.
    """
    path = _FOLDER / f"{name_or_path}.json" if str(name_or_path) in target_names() else Path(name_or_path)
    if path.suffix != ".json" and not path.exists():
        hint = "A path to a file (.json) works too, and so do the logs of sessions (trials.jsonl, or a run's folder)."
        raise UnknownName("targets", str(name_or_path), target_names(), hint)
    found = documents.read(path, _Strict, HthorError, hint=f"see {_FOLDER / 'paper.json'}")
    _check(path, found)
    return Targets(**{name: getattr(found, name) for name in Targets.__struct_fields__})


class _Strict(Targets, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Targets as read from a file, without unknown fields."""


def _check(path: Path, targets: Targets) -> None:
    """Check that numbers are possible, and that counts and ratios agree with the printed percentages."""
    if targets.schema != SCHEMA:
        raise HthorError(f"{path}: schema: is '{targets.schema}', this version reads '{SCHEMA}'.")
    for metric in ("sr", "adoption", "ratio"):
        held: dict[str, Count | float] = getattr(targets, metric)
        if strange := sorted(set(held) - set(CONDITIONS)):
            raise HthorError(
                f"{path}: {metric}: no condition is called '{strange[0]}'; valid: {', '.join(CONDITIONS)}."
            )
    for metric, counts in (("sr", targets.sr), ("adoption", targets.adoption)):
        for name, count in counts.items():
            _check_count(f"{path}: {metric}.{name}", count, targets.published.get(f"{metric} {name}"))
    for name, ratio in targets.ratio.items():
        if name not in targets.sr or f"twsr {name}" not in targets.published:
            raise HthorError(f"{path}: ratio.{name}: needs sr.{name} and the percentage 'twsr {name}' in 'published'.")
        whole = targets.published[f"twsr {name}"] / 100.0 / targets.sr[name].share
        if abs(whole - ratio) > _RATIO_STEP:
            raise HthorError(f"{path}: ratio.{name}: is {ratio}, but TWSR / SR comes to {whole:.3f}.")


def _check_count(place: str, count: Count, printed: float | None) -> None:
    if not 0 <= count.k <= count.n or count.n < 1:
        raise HthorError(f"{place}: {count.k} of {count.n} trials cannot be; expected 0 <= k <= n and n >= 1.")
    if printed is not None and abs(100.0 * count.share - printed) > 0.05 + 1e-9:
        raise HthorError(f"{place}: {count.k}/{count.n} is {100.0 * count.share:.1f} %, but {printed} % was printed.")
