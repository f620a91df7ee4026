"""Estimates parameters from logs and updates a population with them."""

from collections.abc import Callable, Sequence
from pathlib import Path

from msgspec import Struct

from hthor import jsonio, rules, seeds
from hthor.calibration.from_logs import estimate_all, trial_features
from hthor.calibration.from_logs.display_habits import DisplayHabits, display_habits
from hthor.calibration.from_logs.estimate import Estimate
from hthor.calibration.from_logs.models import priors
from hthor.calibration.from_logs.trial_features import Sessions
from hthor.calibration.from_logs.update_population import Updated, update_draws
from hthor.errors import RunError
from hthor.humans.population import parameter_registry, population_file, resolve
from hthor.humans.population.parameters import Parameters
from hthor.humans.population.population import Population, Validity
from hthor.humans.population.resolve import PROXY
from hthor.types.events import Stick

SCHEMA = "hthor.estimates/1"


class EstimateRow(Struct, frozen=True, kw_only=True):
    """A parameter before and after the logs: medians and 90 % intervals in its unit, and its estimate, if any."""

    name: str
    unit: str
    before: float
    before_low: float
    before_high: float
    after: float
    after_low: float
    after_high: float
    estimate: Estimate | None


class LogEstimates(Struct, frozen=True, kw_only=True):
    """The result of a calibration with logs.

    ``effective`` is the effective number of old draws behind the new ones; ``display`` says how people used panel and
    map.
    """

    schema: str = SCHEMA
    prior: str
    people: int
    sessions: int
    trials: int
    effective: float
    widening: float
    rows: tuple[EstimateRow, ...]
    notes: tuple[str, ...]
    display: DisplayHabits


def estimate_from_logs(
    logs: Sequence[Path], prior: str, out: Path, tell: Callable[[str], None], *, seed: int = 0
) -> tuple[LogEstimates, Population]:
    """Estimate, update the population ``prior``, and write both to the folder ``out``.

    Raises:
        RunError: when a log cannot be read, or has no journal of the person's movements.
    """
    seeds.check_seed(seed)
    tell("reading")
    data = trial_features.read_sessions(logs)
    if not any(isinstance(entry, Stick) for one in data.trials for entry in one.record.journal):
        raise RunError(
            f"{logs[0]} has no record of the person's motions and attempts. It was written by an older version of "
            "hthor; repeat the run with 'hthor eval'."
        )
    old = population_file.load_population(resolve.default_population() if prior == PROXY else prior)
    before = priors.population_beliefs(old.names, old.draws, old.weights)
    estimates = estimate_all.estimate_parameters(data, before, tell)
    tell("updating")
    updated = update_draws(old.names, old.draws, old.weights, before, estimates, seed)
    new = _population(old, updated, estimates, data, logs, out, seed)
    found = LogEstimates(
        prior=old.name,
        people=data.people,
        sessions=data.sessions,
        trials=len(data.trials),
        effective=round(updated.effective, 1),
        widening=round(updated.widening, 3),
        rows=_rows(old, new, estimates),
        notes=new.notes,
        display=display_habits(trial_features.extract_features(data)),
    )
    out.mkdir(parents=True, exist_ok=True)
    population_file.save_population(new, out / "population")
    jsonio.write(out / "estimates.json", jsonio.pretty(found))
    return found, new


def _population(
    old: Population,
    updated: Updated,
    estimates: Sequence[Estimate],
    data: Sessions,
    logs: Sequence[Path],
    out: Path,
    seed: int,
) -> Population:
    suites = {one.record.spec.suite_sha256 for one in data.trials}
    few = [one.name for one in estimates if not one.used]
    notes = [
        f"Brought up to date with {len(data.trials)} trials of {data.people} people; {len(updated.direct)} parameters "
        f"were estimated from them, the others were weighted by these ({updated.effective:.0f} effective draws)."
    ]
    if few:
        notes.append(f"The logs have too few data on {', '.join(few)}; they did not change.")
    return Population.make(
        out.resolve().name,
        updated.draws,
        purpose=f"{old.name}, brought up to date with logs of {data.people} people",
        seed=seed,
        command=f"hthor calibrate {' '.join(f'--target {log.name}' for log in logs)} --prior {old.name}",
        names=old.names,
        fixed=_fixed(old, estimates),
        statistics=tuple(f"{one.name}: {one.method}" for one in estimates if one.used),
        figures={"effective": round(updated.effective, 1), "widening": round(updated.widening, 3)},
        notes=notes,
        validity=Validity(
            suite=old.validity.suite if suites == {old.validity.suite_sha256} else "the suite of the logs",
            suite_sha256=next(iter(suites)) if len(suites) == 1 else "",
            targets="logs",
            simulation=rules.SIMULATION,
            mind=parameter_registry.PROXY_VERSION,
        ),
    )


def _fixed(old: Population, estimates: Sequence[Estimate]) -> Parameters:
    """The parameters that are the same for everybody: those of before, and what was measured of them."""
    measured = {one.name: one.value for one in estimates if one.used and one.name in old.fixed}
    return Parameters(**{**old.fixed, **measured})


def _rows(old: Population, new: Population, estimates: Sequence[Estimate]) -> tuple[EstimateRow, ...]:
    by_name = {one.name: one for one in estimates}
    shares = (0.05, 0.5, 0.95)
    before, after = old.quantiles(shares), new.quantiles(shares)
    columns = tuple(
        EstimateRow(
            name=spec.name,
            unit=spec.unit,
            before=float(before[1, k]),
            before_low=float(before[0, k]),
            before_high=float(before[2, k]),
            after=float(after[1, k]),
            after_low=float(after[0, k]),
            after_high=float(after[2, k]),
            estimate=by_name.get(spec.name),
        )
        for k, spec in enumerate(new.specs)
    )
    return (*columns, *(_fixed_row(old, new, one) for one in estimates if one.name in old.fixed))


def _fixed_row(old: Population, new: Population, one: Estimate) -> EstimateRow:
    """The row of a parameter that is the same for everybody."""
    before, after = old.fixed[one.name], new.fixed[one.name]
    return EstimateRow(
        name=one.name,
        unit=one.unit,
        before=before,
        before_low=before,
        before_high=before,
        after=after,
        after_low=after,
        after_high=after,
        estimate=one,
    )
