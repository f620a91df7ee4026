"""What ``info`` has besides the observation and the reward."""

from typing import Any

from hthor.envs.decision_trial import DecisionTrial
from hthor.types import TrialSpec


def information(played: DecisionTrial, trial: TrialSpec | None, seat: str, success: bool) -> dict[str, Any]:
    """The ``info`` of a robot.

    - ``action_mask``: (number of actions,) int8, 1 for the legal actions.
    - ``task``, ``instruction``: the task's id, and the task in words. ``study``, ``participant``: seed and number of
      the person. ``tick``: ticks of 0.1 s since the trial began. ``success``: whether the task is done.
    - ``distance_m``: [m] the true way to the nearest object of the task; infinite if there is none, and unless the
      reward has a weight for ``approach``.
    - ``refused``: why the rules, or the numbering, refused the last action; empty if they did not.
    - ``reward_terms``: the terms of the last reward by name: "goal", "time" and "approach".
    """
    assert trial is not None, "the episode has begun"
    return {
        "action_mask": played.views[seat].mask(),
        "task": trial.task.id,
        "instruction": trial.task.instruction,
        "study": trial.seed,
        "participant": trial.session,
        "tick": played.episode.tick,
        "success": success,
        "distance_m": played.metres(seat),
        "refused": "",
        "reward_terms": dict.fromkeys(("goal", "time", "approach"), 0.0),
    }
