"""What a second person adds: the same tasks by two people together and by each of the two alone, with the same robots.

``python -m benchmarks.second_person tidy rearrange-record --robots scout,scout`` prints one line for every suite.
Unlike two runs of ``hthor eval``, this compares two people with themselves, so that nobody's pace counts as an effect.
"""

from __future__ import annotations

import argparse
import math
import statistics
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import msgspec
from msgspec import Struct

from hthor import rules, tasks
from hthor.episode import EpisodeLog, play
from hthor.tasks.suite import make_suite
from hthor.trials import TrialRunner, robot_team
from hthor.trials.sessions import Session, make_sessions
from hthor.types import TrialSpec
from hthor.types.events import InWay, Progress

Job = tuple[str, Session]


class Played(Struct, frozen=True, kw_only=True):
    """A trial: its task, when it ended [s], the progress reached, and how often one body stopped another."""

    task: str
    seconds: float
    met: bool
    progress: float
    stops: int


def sessions(suite: str, robots: str, agent: str, count: int, limit_s: float | None) -> Iterator[Job]:
    """Sessions of two people ("both"), and the same tasks with the first and with the second of them alone."""
    loaded = tasks.load_suite(suite)
    if limit_s is not None:
        longer = tuple(msgspec.structs.replace(task, time_limit=limit_s) for task in loaded.tasks)
        loaded = make_suite(loaded.name, loaded.version, longer)
    bodies = robots.split(",")
    team = robot_team.form_team(bodies, [agent] * len(bodies), "own")
    pairs = make_sessions(loaded, agent=team, humans="proxy,proxy", participants=2 * count)
    for pair, alone in zip(pairs, make_sessions(loaded, agent=team, humans="proxy", participants=count), strict=True):
        yield "both", pair
        for place, name in enumerate(("first", "second")):
            who = pair.trials[0].humans[place].participant
            yield name, msgspec.structs.replace(alone, trials=tuple(_with(who, trial) for trial in alone.trials))


def _with(participant: int, trial: TrialSpec) -> TrialSpec:
    """The trial with another person in its only seat."""
    (seat,) = trial.humans
    return msgspec.structs.replace(trial, humans=(msgspec.structs.replace(seat, participant=participant),))


def play_session(job: Job) -> tuple[str, list[Played]]:
    """Play the trials of one session, in order."""
    name, session = job
    runner, played = TrialRunner(), []
    with runner.enter(session) as company:
        for trial in session.trials:
            log = play(trial, runner.world(trial), company.humans, company.ready_agents())
            played.append(_summary(log, trial))
            company.finish_trial()
    return name, played


def _summary(log: EpisodeLog, trial: TrialSpec) -> Played:
    values = [event.value for event in log.events if isinstance(event, Progress)]
    return Played(
        task=trial.task.id,
        seconds=log.ticks * rules.TICK_S,
        met=log.met,
        progress=max(values, default=0.0),
        stops=sum(isinstance(event, InWay) for event in log.events),
    )


def line(played: dict[str, list[Played]]) -> str:
    """Means with one person and with both, and the paired difference of the times with its 95 % interval."""
    alone = [*played["first"], *played["second"]]
    both = played["both"]
    pairs = zip(both, played["first"], played["second"], strict=True)
    saved = [b.seconds - (one.seconds + other.seconds) / 2.0 for b, one, other in pairs]
    margin = 1.96 * statistics.stdev(saved) / math.sqrt(len(saved))
    cells = [f"{_mean(alone, 'seconds'):.1f} -> {_mean(both, 'seconds'):.1f} s"]
    cells.append(f"{statistics.mean(saved):+.1f} +- {margin:.1f} s")
    cells.append(f"success {100 * _mean(alone, 'met'):.0f} -> {100 * _mean(both, 'met'):.0f} %")
    cells.append(f"progress {100 * _mean(alone, 'progress'):.0f} -> {100 * _mean(both, 'progress'):.0f} %")
    cells.append(f"stops {_mean(alone, 'stops'):.1f} -> {_mean(both, 'stops'):.1f}")
    return "  ".join(cells) + f"  ({len(both)} tasks)"


def _mean(played: Sequence[Played], name: str) -> float:
    return statistics.fmean(float(getattr(one, name)) for one in played)


def main() -> None:
    """Play the suites and print a line for each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("suites", nargs="+", metavar="SUITE")
    parser.add_argument("--robots", default="scout,scout", help="bodies, as in hthor eval")
    parser.add_argument("--agent", default="oracle")
    parser.add_argument("--sessions", type=int, default=2, help="of ten tasks, each with two people")
    parser.add_argument("--limit", type=float, help="time limit [s] instead of the suite's")
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args()
    with ProcessPoolExecutor(given.jobs, mp_context=get_context("spawn")) as pool:
        for suite in given.suites:
            jobs = sessions(suite, given.robots, given.agent, given.sessions, given.limit)
            played: dict[str, list[Played]] = {"both": [], "first": [], "second": []}
            for name, trials in pool.map(play_session, jobs):
                played[name] += trials
            print(f"{suite:10} {given.robots:16} {line(played)}", flush=True)


if __name__ == "__main__":
    main()
