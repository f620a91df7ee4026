"""The scene priors: counted from the data, weighed from their parts, drawn as they weigh, told truly in the docs."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from typer.testing import CliRunner

from hthor import catalog, houses
from hthor.catalog import priors
from hthor.catalog.priors import making, scenes
from hthor.cli import app
from hthor.errors import UnknownName
from hthor.tasks.arrangement import scene_graph
from hthor.tasks.kinds.mobile_manipulation import TEMPLATES

SAMPLES = 10_000


def present(house: str) -> set[str]:
    """Kinds of a house's things, and the targets."""
    return {thing.kind for thing in houses.load(house).things} | set(catalog.TARGETS)


def applicable(target: str, kinds: set[str]) -> list[priors.Triplet]:
    return [row for row in priors.triplets_of(target) if row.reference in kinds]


# ---- what there is, by counting


def test_65_triplets_19_templates_14_objects_10_scenes() -> None:
    assert len({row.key for row in priors.triplets()}) == len(priors.triplets()) == 65
    assert len({(target, to) for target, places in TEMPLATES.items() for to in places}) == 19
    assert len({*catalog.RECEPTACLES, *catalog.TARGETS}) == 14
    assert len(houses.names()) == 10
    assert priors.targets() == catalog.TARGETS == tuple(TEMPLATES)


def test_565_navigation_and_1583_manipulation_tasks() -> None:
    navigation = manipulation = 0
    for house in houses.names():
        kinds = present(house)
        navigation += sum(row.reference in kinds for row in priors.triplets())
        for target, places in TEMPLATES.items():
            for to in places:
                rows = applicable(target, kinds)
                manipulation += sum((row.relation, row.reference) != (catalog.kind(to).relation, to) for row in rows)
    assert (navigation, manipulation) == (565, 1583)


def test_what_is_optional_is_what_some_house_lacks() -> None:
    everywhere = set.intersection(*(present(house) for house in houses.names()))
    for row in priors.triplets():
        assert row.optional == (row.reference not in everywhere), row.key


def test_every_part_has_its_source() -> None:
    packages = {origin.part: origin.package for origin in priors.table().origins}
    assert set(packages) == {"frequency", "similarity"}
    for row in priors.triplets():
        assert row.source.frequency.startswith(packages["frequency"])
        assert row.source.similarity.startswith(packages["similarity"])
        assert all(kind in row.source.frequency for kind in scenes.types(row.reference))
        assert all(making.phrase(name) in row.source.similarity for name in (row.target, row.reference))


def test_an_unknown_target_names_the_nearest() -> None:
    with pytest.raises(UnknownName, match="Did you mean 'mug'"):
        priors.triplets_of("muug")


# ---- the weights, from the two parts


def test_frequencies_are_the_counts() -> None:
    for row in priors.triplets():
        assert 0 <= row.seen <= row.of
        assert row.frequency == round(row.seen / row.of, 3)
    assert all(len({row.of for row in priors.triplets_of(target)}) == 1 for target in priors.targets())


@pytest.mark.parametrize("target", catalog.TARGETS)
def test_the_two_parts_give_the_shipped_weights(target: str) -> None:
    rows = priors.triplets_of(target)
    often, alike = sum(max(row.frequency, 0.01) for row in rows), sum(math.exp(row.similarity / 0.15) for row in rows)
    for row in rows:
        parts = 0.75 * max(row.frequency, 0.01) / often + 0.25 * math.exp(row.similarity / 0.15) / alike
        assert row.weight == round(parts, 3)


part = st.floats(0.0, 1.0)


@given(st.lists(st.tuples(part, part), min_size=1, max_size=12))
def test_weights_add_up_and_nothing_is_impossible(parts: list[tuple[float, float]]) -> None:
    weights = priors.weigh_triplets([often for often, _ in parts], [alike for _, alike in parts])
    assert sum(weights) == pytest.approx(1.0)
    assert min(weights) > 0.0
    order = sorted(range(len(parts)), key=lambda at: parts[at])
    for less, more in itertools.pairwise(order):
        if parts[less][1] <= parts[more][1]:  # seen as often and as alike, or more: it weighs as much, or more
            assert weights[less] <= weights[more] + 1e-12


# ---- what is drawn


def p_value(counts: Sequence[int], shares: Sequence[float]) -> float:
    """Pearson's chi-square test that counts were drawn with these probabilities."""
    expected = [share * sum(counts) for share in shares]
    assert min(expected) >= 5.0, "too few samples for the test to be valid"
    x = sum((count - mean) ** 2 / mean for count, mean in zip(counts, expected, strict=True)) / 2.0
    a, tail = (0.5, math.erfc(math.sqrt(x))) if len(counts) % 2 == 0 else (1.0, math.exp(-x))
    while a < (len(counts) - 1) / 2.0:  # Q(a + 1, x) = Q(a, x) + x^a e^-x / gamma(a + 1)
        tail += math.exp(a * math.log(x) - x - math.lgamma(a + 1.0))
        a += 1.0
    return tail


@pytest.mark.parametrize(("freedom", "x"), [(1, 6.635), (2, 9.210), (9, 21.666), (14, 29.141)])
def test_the_chi_square_test_knows_the_tables(freedom: int, x: float) -> None:
    cells = freedom + 1  # two counts away from the mean by d give 2 d^2 / mean
    gap = math.sqrt(x * 1000.0 / 2.0)
    counts = [1000.0 + gap, 1000.0 - gap] + [1000.0] * (cells - 2)
    assert p_value(counts, [1.0 / cells] * cells) == pytest.approx(0.01, abs=1e-5)  # type: ignore[arg-type]


@pytest.mark.parametrize("house", ["alder", "birch"])
@pytest.mark.parametrize("target", catalog.TARGETS)
def test_relations_are_drawn_as_they_weigh(target: str, house: str) -> None:
    kinds = present(house)
    rows = applicable(target, kinds)
    assert len(rows) >= 2
    drawn = Counter(scene_graph.draw_triplet(target, kinds, root).key for root in range(SAMPLES))
    counts = [drawn[row.key] for row in rows]
    assert sum(counts) == SAMPLES, "something else was drawn than what the house has"
    total = sum(row.weight for row in rows)
    assert p_value(counts, [row.weight / total for row in rows]) > 0.01
    assert p_value(counts, [1.0 / len(rows)] * len(rows)) < 1e-9, "the test would not notice wrong weights"


def test_the_two_houses_differ_in_every_target() -> None:
    for target in catalog.TARGETS:
        assert applicable(target, present("alder")) != applicable(target, present("birch")), target


# ---- the docs


def ranks(values: Sequence[float]) -> list[float]:
    """Ranks, ties shared."""
    return [
        sum(other < value for other in values) + (sum(other == value for other in values) - 1) / 2 for value in values
    ]


def test_the_docs_state_what_the_data_say(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "120")
    text = (root / "docs/priors.md").read_text(encoding="utf-8")
    rows = priors.triplets()
    pair = ranks([row.similarity for row in rows]), ranks([row.frequency for row in rows])
    spearman = float(np.corrcoef(*pair)[0, 1])
    assert f"Spearman's rank correlation over the 65 triplets is {spearman:.2f}" in " ".join(text.split())
    shown = [line.strip() for line in CliRunner().invoke(app, ["priors", "show"]).stdout.splitlines() if line.strip()]
    assert "\n".join(shown) in "\n".join(line.strip() for line in text.splitlines() if line.strip())
