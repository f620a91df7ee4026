"""A trial as an environment of dm_control's composer, and so of dm_env.

    environment = trial_environment(trial, world, people)
    step = environment.reset()
    while not step.last():
        step = environment.step({"robot": encode_action(decide(step.observation))})

A step is one tick of 0.1 s, whether a robot's body is free or not. The physics of a step, the people, the mail and the
goal are those of a trial in a batch: the same actions at the same ticks give the same trial, byte for byte.
"""

from collections.abc import Callable, Collection, Mapping
from typing import Any

from hthor.envs.episode_control import EpisodeControl
from hthor.humans.model import HumanModel
from hthor.types import TrialSpec
from hthor.world import World


def trial_environment(
    trial: TrialSpec,
    world: World,
    people: Mapping[str, HumanModel] | Callable[[], Mapping[str, HumanModel]],
    observe: Collection[str] = (),
) -> Any:
    """The composer environment of a trial. Its ``task.control`` is the `EpisodeControl`, which has the log.

    Actions and observations are dicts. An action has for each robot's seat the arrays of
    `hthor.envs.action_arrays.action_spec`. The observations are described in `hthor.envs.seat_readings`; their names
    begin with the seat, such as ``robot/pose``. All but the pictures are enabled; like those of any composer task they
    can be switched in ``environment.task.observables``, which takes effect at the next reset. A message counts as shown
    to a robot when anything of that robot was observed.

    Args:
        trial: the trial; every reset begins it again.
        world: the world of the trial's house, robots and objects, which the caller may go on using for other trials.
            After somebody else has reset that world, the next step begins the trial again.
        people: the human model of each person by seat, or a function that makes new ones for every reset. Models that
            are given once remember the trials before, as in a session, so that a second episode differs from the first.
        observe: what to observe of every robot besides: "rgb", "depth", "segmentation".

    Raises:
        HthorError: when the world has other robots than the trial.
        UnknownName: when ``observe`` names no observable.
    """
    environment = world.env
    environment.hand_over(EpisodeControl(trial, world, people if callable(people) else lambda: people, observe))
    return environment
