"""Which trial comes next: seeds as studies, episodes as their participants."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from hthor.envs.trial_source import TrialSource
from hthor.errors import HthorError
from hthor.types import TrialSpec


class StudySeeds:
    """Numbers the people of an environment: a seed is a study, and every episode has its next participant."""

    def __init__(self) -> None:
        self._study: int | None = None
        self._participant = 0

    def trial(
        self, source: TrialSource, random: np.random.Generator, seed: int | None, options: Mapping[str, Any] | None
    ) -> TrialSpec:
        """The next trial; its task is drawn unless ``options`` has the id of one as "task"; other keys are ignored.

        Args:
            seed: begins a new study; None goes on with the present one, or draws the first one's seed.

        Raises:
            HthorError: when ``options`` is no mapping. UnknownName: when there is no such task.
        """
        chosen = _chosen(options)
        if seed is not None or self._study is None:
            self._study, self._participant = int(random.integers(2**31)) if seed is None else int(seed), 0
        else:
            self._participant += 1
        drawn = source.tasks[int(random.integers(len(source.tasks)))]
        return source.trial(drawn if chosen is None else source.find(chosen), self._study, self._participant)


def _chosen(options: Mapping[str, Any] | None) -> Any:
    """The id of the task that the options of ``reset`` name, None if they name none."""
    given = {} if options is None else options
    if not isinstance(given, Mapping):
        raise HthorError(f"options must be a dict, such as {{'task': ID}}, got {given!r:.60}")
    return given.get("task")
