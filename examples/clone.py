"""Learn the policy of `cloned_person.py` from the logs of runs, and test it on participants held out.

    hthor eval --agent frontier --agent oracle --suite paper --humans literature --participants 24 --out runs/clone
    python examples/clone.py runs/clone/frontier runs/clone/oracle

Every decision of a log stands in its journal: a "choice" with what each option was like, an "offer" with what spoke for
and against it. Every fourth participant is held out, with all their trials. The weights are those of a
conditional logit and a logit, with a small penalty on their squares, found by Newton's method.
"""

import argparse
import functools
import math
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import cloned_person as clone
import numpy as np

from hthor import jsonio
from hthor.errors import HthorError
from hthor.eval.records import trial_log
from hthor.humans.population import resolve
from hthor.humans.population.parameters import Parameters
from hthor.humans.population.participant import with_practice
from hthor.humans.search.option_choice import DOORWAY_S, SETTLE_S
from hthor.types import TrialSpec
from hthor.types.events import Choice, Offer, OptionRow

EVERY = 4  # one participant in so many is held out
PENALTY = 0.01
STEPS = 50


class Decisions:
    """The choices and offers of some people."""

    def __init__(self) -> None:
        self.choices: list[tuple[TrialSpec, Sequence[OptionRow], int]] = []
        self.offers: list[Offer] = []
        self.people: set[tuple[int, int]] = set()


def read(runs: Iterable[Path]) -> tuple[Decisions, Decisions]:
    """The decisions of those to learn from, and of those held out.

    Raises:
        HthorError: when a run holds none.
    """
    learn, test = Decisions(), Decisions()
    for run in runs:
        count = 0
        for _, record in trial_log.read(run / "trials.jsonl" if run.is_dir() else run):
            if record.log.voided:
                continue
            side = test if record.spec.session % EVERY == EVERY - 1 else learn
            side.people.add((record.spec.seed, record.spec.session))
            for entry in record.journal:
                count += isinstance(entry, (Choice, Offer))
                if isinstance(entry, Choice) and entry.aim == "target" and len(entry.options) > 1:
                    side.choices.append((record.spec, entry.options, entry.chosen))
                elif isinstance(entry, Offer):
                    side.offers.append(entry)
        if not count:
            raise HthorError(f"{run} holds no choice and no offer. Give the folder of a run with proxies.")
    if not learn.choices or not test.choices or not learn.offers or not test.offers:
        raise HthorError(f"too few people: at least {EVERY} must have chosen and been offered help. Give more runs.")
    return learn, test


def table(decisions: Decisions) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Features (N, M, F) of up to M options a choice, which of them there are (N, M), and the chosen ones (N,)."""
    most = max(len(options) for _, options, _ in decisions.choices)
    width = len(clone.features(decisions.choices[0][1][0]))
    values, there = np.zeros((len(decisions.choices), most, width)), np.zeros((len(decisions.choices), most), bool)
    for number, (_, options, _) in enumerate(decisions.choices):
        values[number, : len(options)] = [clone.features(option) for option in options]
        there[number, : len(options)] = True
    return values, there, np.array([chosen for *_, chosen in decisions.choices])


def fit_choice(values: np.ndarray, there: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """Weights (F,) of the conditional logit."""
    weights, rows = np.zeros(values.shape[2]), np.arange(len(chosen))
    for _ in range(STEPS):
        share = shares(values @ weights, there)
        mean = np.einsum("nm,nmf->nf", share, values)
        slope = (values[rows, chosen] - mean).sum(0) - PENALTY * weights
        spread = np.einsum("nm,nmf,nmg->fg", share, values, values) - mean.T @ mean
        step = np.linalg.solve(spread + PENALTY * np.eye(len(weights)), slope)
        weights = weights + step
        if np.abs(step).max() < 1e-9:
            break
    return weights


def shares(utility: np.ndarray, there: np.ndarray) -> np.ndarray:
    """Chances (N, M) of the options that there are."""
    worth = np.where(there, utility, -np.inf)
    worth = np.exp(worth - worth.max(1, keepdims=True))
    return worth / worth.sum(1, keepdims=True)


def fit_answer(values: np.ndarray, said: np.ndarray) -> np.ndarray:
    """Weights (F,) of the logit of accepting."""
    weights = np.zeros(values.shape[1])
    for _ in range(STEPS):
        chance = 1.0 / (1.0 + np.exp(-np.clip(values @ weights, -30.0, 30.0)))
        slope = values.T @ (said - chance) - PENALTY * weights
        spread = (values * (chance * (1.0 - chance))[:, None]).T @ values
        step = np.linalg.solve(spread + PENALTY * np.eye(len(weights)), slope)
        weights = weights + step
        if np.abs(step).max() < 1e-9:
            break
    return weights


def law(choice: tuple[TrialSpec, Sequence[OptionRow], int]) -> list[float]:
    """What the proxy that chose made of its options: the utilities of its own law, with its own parameters."""
    spec, options, _ = choice
    traits = with_practice(_traits(spec.humans[0].model, spec.seed, spec.humans[0].participant), spec.index)
    found = []
    for knowledge, uniform, metres, exposure, closed, is_door in options:
        belief = traits.w_prior * knowledge + (1.0 - traits.w_prior) * uniform
        seconds = metres / traits.v_pace + (
            DOORWAY_S if is_door else traits.t_dwell + SETTLE_S + closed * traits.t_manip
        )
        found.append(traits.beta * (math.log(max(belief, 1e-12)) - exposure - traits.kappa * math.log(seconds)))
    return found


@functools.cache
def _traits(human: str, seed: int, participant: int) -> Parameters:
    return resolve.resolve_humans(human).participant(seed, participant).traits


def judge(share: Sequence[np.ndarray], chosen: Sequence[int]) -> dict[str, float]:
    """Share of choices where the likeliest option was taken, and mean log-likelihood a choice [nats]."""
    right = np.mean([float(np.argmax(one) == taken) for one, taken in zip(share, chosen, strict=True)])
    likely = np.mean([math.log(max(one[taken], 1e-12)) for one, taken in zip(share, chosen, strict=True)])
    return {"accuracy": round(float(right), 4), "log_likelihood": round(float(likely), 4)}


def judge_choices(test: Decisions, weights: np.ndarray) -> dict[str, dict[str, float]]:
    """The clone beside chance and beside the very law that made the data, on the same choices."""
    chosen = [taken for *_, taken in test.choices]
    values, there, _ = table(test)
    cloned = [one[mask] for one, mask in zip(shares(values @ weights, there), there, strict=True)]
    chance = [np.full(len(options), 1.0 / len(options)) for _, options, _ in test.choices]
    result = {"clone": judge(cloned, chosen), "chance": judge(chance, chosen)}
    result["chance"]["accuracy"] = round(float(np.mean([one[0] for one in chance])), 4)
    try:
        own = [np.exp(np.array(utility) - max(utility)) for utility in map(law, test.choices)]
        result["law"] = judge([one / one.sum() for one in own], chosen)
    except HthorError as error:  # logs of people, or of a model that cannot be found here
        sys.stderr.write(f"the law that made the data is not known here: {error}\n")
    return result


def judge_answers(test: Decisions, weights: np.ndarray, rate: float) -> dict[str, dict[str, float]]:
    """The clone beside the mean rate of accepting."""
    said = [int(offer.answer == "accept") for offer in test.offers]
    chance = [clone.logistic(clone.dot(weights, clone.reasons(offer))) for offer in test.offers]
    pairs = {"clone": chance, "mean_rate": [rate] * len(said)}
    return {name: judge([np.array([1.0 - p, p]) for p in some], said) for name, some in pairs.items()}


def learn_from(runs: Sequence[Path]) -> dict[str, Any]:
    """The document that `cloned_person.py` loads: weights, and how they did on the people held out."""
    learn, test = read(runs)
    choice = fit_choice(*table(learn))
    said = np.array([float(offer.answer == "accept") for offer in learn.offers])
    answer = fit_answer(np.array([clone.reasons(offer) for offer in learn.offers]), said)
    quiet = [offer.answer == "ignore" for offer in learn.offers if offer.answer != "accept"]
    return {
        "schema": clone.SCHEMA,
        "choice": [round(float(weight), 6) for weight in choice],
        "answer": [round(float(weight), 6) for weight in answer],
        "ignored": round(float(np.mean(quiet)), 6) if quiet else 0.0,
        "learnt_from": {"people": len(learn.people), "choices": len(learn.choices), "offers": len(learn.offers)},
        "held_out": {
            "people": len(test.people),
            "choices": len(test.choices),
            "offers": len(test.offers),
            "choice": judge_choices(test, choice),
            "answer": judge_answers(test, answer, float(said.mean())),
        },
    }


def report(found: dict[str, Any]) -> list[str]:
    """How well the weights did, as a table in Markdown."""
    learnt, held = found["learnt_from"], found["held_out"]
    rows = [
        f"| held out: {held['people']} people; learnt from {learnt['people']} | right | log-likelihood [nats] |",
        "|---|---|---|",
    ]
    names = {
        "clone": "the clone",
        "chance": "chance",
        "law": "the law that made the data",
        "mean_rate": "the mean rate",
    }
    for what, count in (("choice", "choices"), ("answer", "offers")):
        for name, scores in held[what].items():
            right, likely = scores["accuracy"], scores["log_likelihood"]
            rows.append(f"| {what} ({held[count]}): {names[name]} | {100 * right:.0f} % | {likely:.2f} |")
    return rows


def main() -> None:
    """Learn, write, report."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("runs", nargs="+", type=Path, help="folders of runs, or their trials.jsonl")
    parser.add_argument("--out", type=Path, default=clone.WEIGHTS, help="where to write the weights")
    given = parser.parse_args()
    try:
        found = learn_from(given.runs)
    except HthorError as error:
        sys.stderr.write(f"error: {error}\n")
        sys.exit(error.exit_code)
    jsonio.write(given.out, jsonio.pretty(found))
    sys.stdout.write("\n".join(report(found)) + "\n")
    sys.stdout.write(f"{given.out}\n")


if __name__ == "__main__":
    main()
