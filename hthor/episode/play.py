"""Plays a trial with human models and agents, from its beginning to its end."""

from collections.abc import Mapping, Sequence

from hthor.episode.clocks import DecisionClock, LockStep, make_clock
from hthor.episode.episode import Episode
from hthor.episode.frames import Frames
from hthor.episode.recording.episode_log import EpisodeLog
from hthor.episode.trial_world import TrialWorld
from hthor.humans.model import HumanModel
from hthor.types import Mind, TrialSpec
from hthor.types.events import Event, Predicted


def play(
    trial: TrialSpec,
    world: TrialWorld,
    humans: Mapping[str, HumanModel],
    robots: Mapping[str, Mind],
    clock: DecisionClock | None = None,
) -> EpisodeLog:
    """Run one trial from reset to its end.

    Args:
        trial: its task names the house, the starts, the goal and the time limit.
        world: the simulation of the task's house, with a body for every seat.
        humans: the human model of each person, by seat, which may remember earlier trials of the session.
        robots: the agent of each robot, by seat.
        clock: when agents' answers take effect; by default the decision clock that the trial names.

    Raises:
        Exception: any exception of a human model or the world; errors of agents become faults in the log.
    """
    episode = Episode(trial, world, (*humans, *robots))
    episode.reset()
    frames = Frames(episode, {**humans, **robots})
    if clock is None:
        clock = make_clock(trial) if robots.keys() - frames.seats else LockStep()  # nobody's thinking takes time
    try:
        begin(episode, humans, robots, clock)
        while not episode.done:
            ask(episode, humans, robots, clock, frames)
            take_answers(episode, clock)
            frames.play()
            if happened := episode.advance():
                record_beliefs(happened, humans)
    finally:
        clock.close()
    return finish(episode, humans)


def record_beliefs(events: Sequence[Event], humans: Mapping[str, HumanModel]) -> None:
    """Let human models that know their beliefs record those that a robot has predicted."""
    for event in events:
        if isinstance(event, Predicted) and (tell := getattr(humans[event.person], "record_belief", None)) is not None:
            tell(event.tick, event.object)


def ask(
    episode: Episode,
    humans: Mapping[str, HumanModel],
    robots: Mapping[str, Mind],
    clock: DecisionClock,
    frames: Frames,
) -> None:
    """Ask everybody who is free what to do, except those who act in every step; agents may answer later."""
    for seat in episode.waiting:
        if seat in frames.seats:
            continue
        if seat in humans:
            episode.submit(seat, humans[seat].act(episode.observe(seat)))
        elif not clock.busy(seat):
            clock.ask(seat, robots[seat], episode.observe(seat, frozen=clock.frozen))


def finish(episode: Episode, humans: Mapping[str, HumanModel]) -> EpisodeLog:
    """Ask people for their ratings, unless the trial is void, and return the log."""
    ratings = {seat: human.rate(episode.met, episode.tick) for seat, human in humans.items() if not episode.voided}
    return episode.log(ratings, {seat: getattr(human, "journal", ()) for seat, human in humans.items()})


def begin(episode: Episode, humans: Mapping[str, HumanModel], robots: Mapping[str, Mind], clock: DecisionClock) -> None:
    """Brief everybody; an agent that fails leaves the trial."""
    for seat, human in humans.items():
        human.begin(episode.briefing(seat))
    for seat, mind in robots.items():
        try:
            clock.begin(seat, mind, episode.briefing(seat))
        except Exception as error:
            episode.retire(seat, error)


def take_answers(episode: Episode, clock: DecisionClock) -> None:
    """Submit the answers that take effect now; an agent that failed leaves the trial."""
    for answer in clock.answers(episode.tick):
        if answer.action is not None:
            episode.submit(answer.seat, answer.action, answer.observation)
        else:
            assert answer.error is not None
            episode.retire(answer.seat, answer.error)
