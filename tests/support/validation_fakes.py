"""Tables of made-up trials and made-up findings of a calibration, for the tests of the validation report."""

from __future__ import annotations

import numpy as np

from hthor.calibration import evidence as ev
from hthor.calibration.simulation import trial_table as tables
from hthor.calibration.simulation.trial_table import Table
from hthor.calibration.targets import CONDITIONS
from hthor.humans.population import parameter_registry

LEAST = np.linspace(20.0, 50.0, 30)
RATES = {"none": 0.64, "frontier": 0.73, "oracle": 0.91}
ADOPTS = {"none": 0.0, "frontier": 0.56, "oracle": 0.90}


def trials(people: int = 12, seed: int = 0, sr: dict[str, float] = RATES, adopts: dict[str, float] = ADOPTS) -> Table:
    """Trials with given rates; a round of three people does every task once."""
    chance = np.random.default_rng(seed)
    rows = []
    for number, condition in enumerate(CONDITIONS):
        for participant in range(people):
            order = chance.permutation(10)
            for index in range(10):
                met = chance.random() < sr[condition]
                adopted = chance.random() < adopts[condition]
                trust = (
                    0
                    if number == 0
                    else int(np.clip(round(3.2 + number * 0.5 + 0.08 * index * number + chance.normal(0, 0.8)), 1, 7))
                )
                rows.append(
                    {
                        "study": -1,
                        "session": number * 1000 + participant,
                        "point": 0,
                        "condition": number,
                        "participant": participant,
                        "index": index,
                        "task": int(order[index]) * 3 + participant % 3,
                        "met": met,
                        "ticks": int(chance.uniform(250, 890)) if met else 900,
                        "sent": 50 if number else -1,
                        "shown": 60 if number and (adopted or chance.random() < 0.3) else -1,
                        "accepted": 80 if adopted else -1,
                        "declined": -1,
                        "picked": 300 if met else -1,
                        "messages": int(number > 0),
                        "adopted": adopted,
                        "trust": trust,
                        "valid": True,
                        "counted": number > 0,
                    }
                )
    columns = {name: [row[name] for row in rows] for name in tables.COLUMNS}
    return tables.build_table(("none",), np.zeros((1, 1)), columns)


def band(middle: float, half: float) -> ev.Band:
    return ev.Band(low=middle - half, median=middle, high=middle + half)


def evidence(figures: dict[str, float], seed: int = 1) -> ev.Evidence:
    """Evidence around given figures, with everything in it."""
    chance = np.random.default_rng(seed)
    others = {name: tuple(other for other in CONDITIONS if other != name) for name in CONDITIONS}
    return ev.Evidence(
        origin=ev.Origin(
            population_sha256="ab" * 32,
            targets_sha256="cd" * 32,
            suite="paper",
            suite_sha256="ef" * 32,
            simulation=1,
            seed=0,
            trials=40_000,
            draws=2000,
            effective=640.0,
        ),
        predictive=tuple(
            ev.PredictedFigure(
                figure=name,
                prior=band(0.5, 0.35),
                posterior=band(value - 0.01, 0.12),
                design_effect=None if name.startswith("twsr") else 1.7,
            )
            for name, value in figures.items()
        ),
        held_out=tuple(
            ev.HeldOutCondition(
                condition=condition,
                fitted=others[condition],
                figures=tuple(
                    ev.HeldOutFigure(figure=name, published=value, band=band(value + 0.03, 0.10))
                    for name, value in figures.items()
                    if name.endswith(condition)
                ),
                log_score=-5.1 - number,
                log_score_prior=-7.4 - number,
                rivals={"greedy": -12.0, "random": -30.5},
            )
            for number, condition in enumerate(CONDITIONS)
        ),
        parameters=tuple(
            ev.ParameterFinding(
                name=one.name,
                unit=one.unit,
                meaning=one.meaning,
                grade=one.grade,
                fitted=one.fitted,
                prior=ev.Band(
                    **{end: one.prior.quantile(u) for end, u in (("low", 0.05), ("median", 0.5), ("high", 0.95))}
                ),
                posterior=ev.Band(
                    **{end: one.prior.quantile(u) for end, u in (("low", 0.3), ("median", 0.5), ("high", 0.7))}
                ),
                contraction=float(chance.uniform(0.05, 0.8)) if one.fitted else float(chance.uniform(0.0, 0.06)),
                recovery=float(chance.uniform(0.2, 0.9)) if one.fitted else float(chance.uniform(-0.1, 0.3)),
                coverage=float(chance.uniform(0.86, 0.94)),
                ranks=tuple(int(n) for n in chance.multinomial(200, np.full(10, 0.1))) if one.fitted else (),
            )
            for one in parameter_registry.PARAMETERS
            if one.prior is not None
        ),
        coverage=ev.CoverageFinding(studies=240, mean=0.902, low=0.87, high=0.94),
        emulator_z=1.03,
        emulated=tuple(
            ev.EmulatorFit(
                outcome=outcome,
                condition=condition,
                z_sd=1.0 + 0.02 * number,
                score=-0.41,
                baseline=-0.52,
                bins=tuple(
                    (x / 10, min(1.0, max(0.0, x / 10 + float(chance.normal(0, 0.02)))), 300) for x in range(1, 10)
                ),
            )
            for outcome in ("success", "adoption")
            for number, condition in enumerate(CONDITIONS)
            if outcome == "success" or condition != "none"
        ),
        abc=tuple(
            ev.AbcShift(name=one.name, shift=float(chance.normal(0, 0.15)))
            for one in parameter_registry.PARAMETERS
            if one.fitted
        ),
        rankings=(
            ev.RobotRanking(
                suite="paper",
                draws=2000,
                trials=600,
                sr=0.97,
                twsr=0.985,
                both=0.96,
                swings=tuple(
                    ev.ParameterSwing(
                        name=one.name,
                        better=better,
                        worse=worse,
                        low=base + float(chance.normal(0, 0.03)),
                        high=base + float(chance.normal(0, 0.03)),
                    )
                    for better, worse, base in (("oracle", "frontier", 0.18), ("frontier", "none", 0.09))
                    for one in parameter_registry.PARAMETERS
                ),
            ),
        ),
    )
