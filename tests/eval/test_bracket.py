"""What is concluded of robots, and what of it flips between greedy and random people."""

from __future__ import annotations

import functools

import eval_fakes
import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hthor.errors import HthorError
from hthor.eval.comparison import population_matrix
from hthor.eval.config import run_config
from hthor.eval.results import aggregate, result_file
from hthor.eval.statistics import intervals
from hthor.trials import human_team, robot_team

CREWS = {
    "silent": robot_team.form_team(["scout"], [eval_fakes.character("silent", absent=True)]),
    "frontier": eval_fakes.crew("frontier"),
    "oracle": eval_fakes.crew("oracle"),
}
SUITE = eval_fakes.suite(30)


@functools.cache
def nothing(agent: str, model: str) -> result_file.RunResult:
    """The result of a run without a trial."""
    who = human_team.form_team([msgspec.structs.replace(eval_fakes.persons(model), model=model)])
    return aggregate.make_result(
        run_config.build_config(SUITE, CREWS[agent], humans=who, seed=0, participants=None), [], []
    )


def result(agent: str, model: str, sr: float, half: float = 0.05, trials: int = 60) -> result_file.RunResult:
    """A run's result with this success rate, and half of it for the time-weighted one."""

    def about(mean):
        return intervals.Estimate(mean=mean, ci95=(mean - half, mean + half), n=trials)

    empty = nothing(agent, model)
    metrics = msgspec.structs.replace(empty.metrics, sr=about(sr), twsr=about(sr / 2.0))
    counts = msgspec.structs.replace(empty.counts, trials=trials)
    return msgspec.structs.replace(empty, metrics=metrics, counts=counts)


def results(**rates: tuple[float, ...]) -> dict[str, list[result_file.RunResult]]:
    """By people, the rates of silent, frontier and oracle, or of the first of them."""
    models = {"paper": "proxy", "slow": "proxy"}
    return {
        people: [result(agent, models.get(people, people), rate) for agent, rate in zip(CREWS, some, strict=False)]
        for people, some in rates.items()
    }


def flips(found: dict[str, list[result_file.RunResult]]) -> tuple[population_matrix.Conclusion, ...]:
    return tuple(one for one in population_matrix.draw_conclusions(found) if one.verdict == "flips")


def test_what_holds_at_both_ends_is_no_flip():
    found = results(paper=(0.6, 0.7, 0.9), greedy=(0.5, 0.8, 0.9), random=(0.1, 0.11, 0.12))
    assert flips(found) == ()
    told = population_matrix.draw_conclusions(found)
    assert [(one.better, one.worse, one.metric) for one in told] == [
        (better, worse, metric)
        for metric in ("sr", "twsr")
        for better, worse in (("frontier", "silent"), ("oracle", "silent"), ("oracle", "frontier"))
    ]
    assert {one.verdict for one in told} == {"holds"}


def test_what_flips_is_flagged_with_its_numbers():
    found = flips(results(paper=(0.6, 0.7, 0.9), greedy=(0.5, 0.95, 0.8), random=(0.1, 0.12, 0.14)))
    assert [(one.better, one.worse, one.metric) for one in found] == [
        ("oracle", "frontier", "sr"),
        ("oracle", "frontier", "twsr"),
    ]
    assert found[0].sentence == (
        "oracle is better than frontier in SR: +20.0 paper, -15.0 greedy, +2.0 random points; "
        "flips with greedy people, so it rests on how people are modelled"
    )
    assert [round(gap.mean, 9) for gap in found[0].gaps] == [0.2, -0.15, 0.02]


def test_a_robot_that_helps_is_said_to_help():
    (one, _) = flips(results(paper=(0.6, 0.7), greedy=(0.5, 0.7), random=(0.12, 0.10)))
    assert one.helps
    assert one.sentence.startswith("frontier helps (over no robot) in SR: ")
    assert "+10.0 paper, +20.0 greedy, -2.0 random points" in one.sentence
    assert "(within chance)" in one.sentence


def test_no_difference_at_an_end_is_said_and_is_no_flip():
    told = population_matrix.draw_conclusions(results(paper=(0.6, 0.7), greedy=(0.5, 0.7), random=(0.1, 0.1)))
    assert {one.verdict for one in told} == {"vanishes"}
    assert "no difference at all with random people" in told[0].sentence


def test_what_holds_only_within_chance_says_so():
    told = population_matrix.draw_conclusions(results(paper=(0.6, 0.9), greedy=(0.5, 0.9), random=(0.1, 0.12)))
    assert told[0].sentence.endswith("holds at both ends, though not everywhere beyond chance")
    sure = population_matrix.draw_conclusions(results(paper=(0.6, 0.9), greedy=(0.5, 0.9), random=(0.1, 0.3)))
    assert sure[0].sentence.endswith("holds at both ends")


def test_every_population_in_between_is_judged():
    found = flips(results(paper=(0.6, 0.9), slow=(0.5, 0.4), greedy=(0.5, 0.9), random=(0.1, 0.3)))
    assert [(one.gaps[0].people, one.better) for one in found] == [("slow", "silent"), ("slow", "silent")]


def test_a_tie_of_the_population_is_no_conclusion():
    assert population_matrix.draw_conclusions(results(paper=(0.6, 0.6), greedy=(0.5, 0.9), random=(0.1, 0.3))) == ()


RATE = st.integers(0, 20).map(lambda n: n / 20)


@given(
    st.lists(RATE, min_size=3, max_size=3),
    st.lists(RATE, min_size=3, max_size=3),
    st.lists(RATE, min_size=3, max_size=3),
)
def test_a_flip_is_a_sign_that_changes_and_nothing_else(paper, greedy, random):
    told = population_matrix.draw_conclusions(results(paper=tuple(paper), greedy=tuple(greedy), random=tuple(random)))
    assert len(told) == 2 * len({(a, b) for a in range(3) for b in range(a) if paper[a] != paper[b]})
    place = dict(zip(CREWS, range(3), strict=True))
    for one in told:
        a, b = place[one.better], place[one.worse]
        assert paper[a] > paper[b]
        assert (one.verdict == "flips") == (greedy[a] < greedy[b] or random[a] < random[b])
        assert one.verdict in one.sentence or one.verdict == "vanishes"
    assert flips(results(paper=tuple(paper), greedy=tuple(greedy), random=tuple(random))) == tuple(
        one for one in told if one.verdict == "flips"
    )


def test_what_is_no_bracket_is_an_error():
    with pytest.raises(HthorError, match="people who accept everything, of random people and of a population"):
        flips(results(paper=(0.6, 0.7), greedy=(0.5, 0.7)))
    with pytest.raises(HthorError, match="people who accept everything, of random people and of a population"):
        flips(results(random=(0.6, 0.7), greedy=(0.5, 0.7)))
    uneven = results(paper=(0.6, 0.7), greedy=(0.5, 0.7), random=(0.1,))
    with pytest.raises(HthorError, match="the same robots on the same trials"):
        flips(uneven)
