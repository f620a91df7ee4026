"""Ranks: laws of order, and what is shown as a tie."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases

from hthor.eval.comparison import ranking
from hthor.eval.metrics import registry
from hthor.eval.results import paired_difference

TRIALS = 80
TASKS, PEOPLE = np.arange(TRIALS), np.arange(TRIALS) // 10
BOARD = st.lists(st.tuples(st.floats(0.2, 0.9), st.integers(0, 3)), min_size=2, max_size=5)
"""Rates, and seeds: agents with the same seed fail at much the same trials."""
few = settings(max_examples=cases(15))


def _played(agents: list[tuple[float, int]]) -> np.ndarray:
    return np.array([np.random.default_rng(seed).random(TRIALS) < rate for rate, seed in agents], dtype=float)


@few
@given(BOARD, st.randoms(use_true_random=False))
def test_the_order_in_which_agents_are_named_does_not_matter(agents, chance):
    order = list(range(len(agents)))
    chance.shuffle(order)
    played = _played(agents)
    found, mixed = ranking.rank_agents(played, TASKS, PEOPLE), ranking.rank_agents(played[order], TASKS, PEOPLE)
    for place, one in enumerate(order):
        assert (mixed[place].rank, mixed[place].interval) == (found[one].rank, found[one].interval)
        assert {order[tie] for tie in mixed[place].ties} == set(found[one].ties)


@few
@given(BOARD)
def test_ranks_lie_in_their_intervals_follow_the_means_and_tie_both_ways(agents):
    played = _played(agents)
    found = ranking.rank_agents(played, TASKS, PEOPLE)
    assert min(one.rank for one in found) == 1
    for number, one in enumerate(found):
        assert 1 <= one.interval[0] <= one.rank <= one.interval[1] <= len(found)
        assert all(number in found[tie].ties for tie in one.ties)
        for other, beside in enumerate(found):
            if (played[other] >= played[number]).all():
                assert beside.rank <= one.rank, "who does all that another does is never below it"
            if played[other].sum() == played[number].sum():
                assert beside.rank == one.rank


def test_equal_agents_are_tied_and_a_far_better_one_is_first():
    weak, strong = _played([(0.3, 1)])[0], _played([(0.95, 1)])[0]
    first, second, third = ranking.rank_agents(np.stack([weak, strong, weak]), TASKS, PEOPLE)
    assert (second.rank, second.interval, second.ties) == (1, (1, 1), ())
    assert (first.rank, first.interval, first.ties) == (2, (2, 3), (2,))
    assert (third.rank, third.interval, third.ties) == (2, (2, 3), (0,))
    assert ranking.rank_agents(weak[None], TASKS, PEOPLE) == (ranking.Rank(rank=1, interval=(1, 1), ties=()),)


def test_ranks_are_those_that_compare_would_give():
    played = _played([(0.4, 1), (0.6, 1), (0.8, 1), (0.78, 2)])
    versus = [paired_difference.difference_spread(played - one, TASKS, PEOPLE, share=True) for one in played]
    pairs = [(one, other) for one in range(4) for other in range(one + 1, 4)]
    success = registry.get("sr")
    found = [
        paired_difference.difference_of_values(played[one], played[other], TASKS, PEOPLE, success, limit_s=None)
        for one, other in pairs
    ]
    assert [ranking.adjusted_p_values(versus)[pair] for pair in pairs] == paired_difference.holm_adjusted(
        [gap.p for gap in found]
    )


def test_the_same_name_gives_the_same_samples_and_rows_share_them():
    rows = np.stack([(np.arange(TRIALS) % 3 == 0).astype(float)] * 2)
    first, again, other = (ranking.bootstrap_means(rows, TASKS, PEOPLE, name=name, draws=300) for name in "xxy")
    assert (first == again).all()
    assert (first[0] == first[1]).all()
    assert (first != other).any()
    assert first.mean() == pytest.approx(rows[0].mean(), abs=0.02)
