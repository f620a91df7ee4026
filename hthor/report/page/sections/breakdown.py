"""Success by difficulty, kind of task, split, scene and human population, with the gain over no robot."""

from collections.abc import Iterable, Mapping, Sequence

from hthor.eval.metrics import registry
from hthor.eval.results.paired_difference import Difference
from hthor.eval.statistics.intervals import NOTHING
from hthor.report.analysis.document import Findings, Split
from hthor.report.html import elements
from hthor.report.html.elements import Band, Piece
from hthor.report.html.number_format import listed
from hthor.report.page import sentences, table_cells

_KEYS = {"difficulty": "difficulty", "kind of task": "kind", "split": "split", "scene": "scene"}
_LONG = 12
"""A table of more groups is folded."""
Gains = dict[str, dict[str, Difference]]
"""Differences in success by group and robot."""


def difficulty(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    """The parts of the section by difficulty."""
    held = [one for one in found.splits if one.word != "scene"]
    if not held:
        return [
            elements.paragraph(
                "These tasks name no difficulty, and are all of one kind and split; or there is one trial of each."
            )
        ]
    said = [sentences.extreme_gains(one.word, _gains(found, one)) for one in held if one.word == "difficulty"]
    by = listed(one.word for one in held)
    return _made(found, held, said, drawings, "difficulty", f"Success rates by {by} with 95 % intervals.")


def scenes(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    """The parts of the section by scene."""
    held = [one for one in found.splits if one.word == "scene"]
    if not held:
        return [elements.paragraph("All trials are in one scene, or there is one trial in each.")]
    said = [sentences.extreme_gains(one.word, _gains(found, one)) for one in held]
    caption = "Success rates by scene with 95 % intervals, the scenes in which people do worst first."
    return _made(found, held, said, drawings, "scenes", caption)


def people(found: Findings, drawings: Mapping[str, str]) -> list[str]:
    """The parts of the section by human population."""
    if found.by_people is None:
        return [
            elements.paragraph(
                f"All people in these runs are '{found.people}'. Runs with several kinds, as from 'hthor eval --humans "
                "kinds', are compared here."
            )
        ]
    said = [
        sentences.worst_population(found.by_people),
        sentences.extreme_gains("kind of person", _gains(found, found.by_people)),
    ]
    caption = "Success rates with each kind of people, with 95 % intervals."
    return _made(found, [found.by_people], said, drawings, "people", caption)


def _made(
    found: Findings, held: Sequence[Split], said: Sequence[str], drawings: Mapping[str, str], name: str, caption: str
) -> list[str]:
    labels = _ordered(found, (label for one in held for group in one.groups for label in group.sr))
    helped = _ordered(found, (label for one in held for by in _gains(found, one).values() for label in by))
    head = ("", *labels, *(f"gain by {label}" for label in helped))
    rows: list[list[Piece] | Band] = []
    success = registry.get("sr")
    for one in held:
        rows += [Band(one.word)] if len(held) > 1 else []
        gains = _gains(found, one)
        for group in one.groups:
            rates = [table_cells.estimate(group.sr.get(label, NOTHING)) for label in labels]
            own = gains.get(group.name, {})
            rows.append([group.name, *rates, *(table_cells.difference(own.get(one), success) for one in helped)])
    long = any(len(one.groups) > _LONG for one in held)
    told = "Success rates [%]" + (", and gains over no robot [points]" if helped else "")
    table = elements.table(head, rows, f"{told}. {table_cells.NOTE}")
    return [
        *(elements.paragraph(text) for text in said if text),
        elements.drawn(drawings, name, caption),
        elements.folded(f"The same in numbers, {len(rows)} rows", table) if long else table,
    ]


def _ordered(found: Findings, labels: Iterable[str]) -> list[str]:
    """Each label once; labels of the page's runs come first, in the order of the runs."""
    there = set(labels)
    own = [arm.label for arm in found.arms if arm.label in there]
    return [*own, *sorted(there.difference(own))]


def _gains(found: Findings, split: Split) -> Gains:
    """The gain of each robot within each group, if its trials can be paired with trials without a robot."""
    if split.word not in _KEYS:
        return {
            people: {pair.second: pair.differences["sr"] for pair in pairs}
            for people, pairs in found.people_uplift.items()
        }
    gains: Gains = {}
    for pair in found.uplift:
        for name, one in pair.groups.get(_KEYS[split.word], {}).items():
            gains.setdefault(name.replace("_", " ") if split.word == "kind of task" else name, {})[pair.second] = one
    return gains
