"""Whether trials through `env.step` of composer are those of the batch: `python -m benchmarks.composer_trials`.

Every trial is played twice, with new people and robots for each session: by `hthor.episode.play`, and step by step
through the environment, where each robot's action is turned into arrays and back. The two records, with events, paths,
journals and ratings, have to be equal byte for byte. It also compares the CPU times.
"""

from __future__ import annotations

import argparse
import itertools
import sys
import time
from collections.abc import Iterator, Mapping

from hthor import code_identity, tasks
from hthor.envs import encode_action, trial_environment
from hthor.episode import EpisodeLog, play
from hthor.eval.records import trial_record
from hthor.humans.model import HumanModel
from hthor.trials import TrialRunner
from hthor.trials.sessions import Session, make_sessions
from hthor.types import Action, Mind, TrialSpec
from hthor.world import World

WAITING = encode_action(Action())


def play_in_steps(
    trial: TrialSpec, world: World, humans: Mapping[str, HumanModel], agents: Mapping[str, Mind]
) -> EpisodeLog:
    """Play a trial through composer's environment, and ask agents when the batch would."""
    environment = trial_environment(trial, world, humans)
    control, step = environment.task.control, environment.reset()
    for seat, agent in agents.items():
        agent.begin(control.episode.briefing(seat))
    while not step.last():
        asked = [seat for seat in agents if step.observation[f"{seat}/asked"]]
        action = {seat: encode_action(agents[seat].act(control.episode.observe(seat))) for seat in asked}
        step = environment.step({**dict.fromkeys(agents, WAITING), **action})
    log: EpisodeLog = control.log()
    environment.close()
    return log


def line(trial: TrialSpec, log: EpisodeLog) -> bytes:
    """The trial's line in a run's log."""
    return trial_record.encode(trial_record.make_record(trial, log))


def compare(session: Session, runner: TrialRunner) -> Iterator[tuple[TrialSpec, bool, float, float]]:
    """Each trial of a session, whether both ways of playing it are equal, and the CPU time of each [s]."""
    with runner.enter(session) as batch, runner.enter(session) as stepped:
        for trial in session.trials:
            world = runner.world(trial)
            began = time.process_time()
            expected = play(trial, world, batch.humans, batch.ready_agents())
            between = time.process_time()
            found = play_in_steps(trial, world, stepped.humans, stepped.ready_agents())
            ended = time.process_time()
            yield trial, line(trial, found) == line(trial, expected), between - began, ended - between


def main() -> None:
    """Compare, and exit with 1 if any trial differs."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--trials", type=int, default=60, help="with each agent (%(default)s)")
    parser.add_argument("--suite", default="smoke", help=f"one of {', '.join(tasks.suite_names())} (%(default)s)")
    parser.add_argument("--agent", action="append", help="may be given more than once (frontier, oracle)")
    given = parser.parse_args()
    code_identity.keep_compiled()
    equal = True
    for agent in given.agent or ("frontier", "oracle"):
        sessions, runner = make_sessions(tasks.load_suite(given.suite), agent=agent), TrialRunner()
        played = (one for session in sessions for one in compare(session, runner))
        found = list(itertools.islice(played, given.trials))
        same = sum(alike for _, alike, _, _ in found)
        batch, steps = sum(one[2] for one in found), sum(one[3] for one in found)
        ticks = f"{1000 * batch / len(found):.1f} ms a trial in the batch, {1000 * steps / len(found):.1f} ms in steps"
        print(f"{agent}: {same} of {len(found)} trials equal byte for byte; CPU time {ticks}")
        for trial, alike, _, _ in found:
            if not alike:
                print(f"  session {trial.session}, trial {trial.index}, task {trial.task.id} differs")
        equal &= same == len(found)
    sys.exit(0 if equal else 1)


if __name__ == "__main__":
    main()
