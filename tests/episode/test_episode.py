"""The umpire's laws, in a world without an engine."""

from __future__ import annotations

import pytest
from episode_fakes import Mind, Stage, trial
from msgspec import UNSET

from hthor import plugins
from hthor.episode import Episode, EpisodeLog, play
from hthor.tasks.kinds.object_goal_navigation import ObjectGoalNavigation
from hthor.types import HUMAN, Action, Briefing, Motion, Move, Observation, Reply, Send, Snapshot, TaskSpec, Wait
from hthor.types.events import Event, Placed


def run(stage: Stage, human: Mind, robot: Mind | None, *privileges: str) -> EpisodeLog:
    return play(trial(*privileges), stage, {"human": human}, {"robot": robot} if robot else {})  # type: ignore[arg-type]


def kinds(log: EpisodeLog) -> list[str]:
    return [event.kind for event in log.events]


def test_the_limit_is_nine_hundred_ticks_exactly() -> None:
    log = run(Stage(), Mind(), Mind())
    assert (log.ticks, log.met, kinds(log)[-1]) == (900, False, "timeout")
    assert len(log.paths[HUMAN]) == len(log.paths["robot"]) == 451


def test_it_ends_at_the_first_tick_at_which_the_goal_is_met() -> None:
    log = run(Stage(seen=37), Mind(), Mind())
    assert (log.ticks, log.met, log.ratings, kinds(log)[-1]) == (37, True, {"human": 5}, "success")


def test_success_at_the_last_tick_counts() -> None:
    assert run(Stage(seen=900), Mind(), Mind()).met


def test_a_busy_body_is_not_asked() -> None:
    robot = Mind(lambda _: Action(motion=Move(forward=0.5)))
    run(Stage(seen=20, busy=5), Mind(), robot)
    assert [seen.tick for seen in robot.observed] == [0, 5, 10, 15]


def test_a_busy_person_is_asked_when_mail_comes_and_only_their_words_count() -> None:
    human = Mind(lambda _: Action(motion=Move(forward=0.1)))
    robot = Mind(lambda now: Action(say=Send(text="here") if now.tick == 0 else None))
    stage = Stage(seen=12, busy=10)
    run(stage, human, robot)
    assert [(seen.tick, seen.idle, len(seen.inbox)) for seen in human.observed] == [
        (0, True, 0),
        (1, False, 1),
        (10, True, 1),
    ]
    assert [tick for tick, seat, _ in stage.started if seat == HUMAN] == [0, 10]


def test_all_seats_see_the_same_moment() -> None:
    """A message of tick 3 cannot be answered at tick 3, whoever is asked first."""
    human = Mind(lambda now: Action(say=Reply(message=now.inbox[0].id, accept=True) if now.inbox else None))
    robot = Mind(lambda now: Action(say=Send(text="here", object="apple") if now.tick == 3 else None))
    log = run(Stage(seen=9), human, robot)
    life = {event.kind: event.tick for event in log.events}
    assert (life["sent"], life["shown"], life["accepted"]) == (3, 4, 4)
    statuses = [(seen.tick, seen.receipt.status) for seen in robot.observed if seen.receipt]
    assert statuses[0] == (4, "sent")
    assert (5, "accepted") in statuses


def test_no_picture_is_taken_that_nobody_looks_at() -> None:
    robot = Mind(lambda now: Action(say=Send(text="here")))
    stage = Stage(seen=9)
    run(stage, Mind(), robot)
    assert stage.frames == 0
    human = Mind(lambda now: Action(motion=Wait(seconds=len(now.inbox) and now.inbox[0].image())))
    run(stage, human, robot)
    assert stage.frames > 0


def test_truth_and_the_house_are_for_the_privileged() -> None:
    plain, knowing = Mind(), Mind()
    run(Stage(seen=3), Mind(), plain)
    assert not plain.observed[0].truth
    assert plain.briefing.house is None
    assert plain.briefing.labels == ()
    human, stage = Mind(), Stage(seen=3)
    run(stage, human, knowing, "object_poses", "house_map", "pixel_labels")
    assert knowing.observed[0].truth
    assert knowing.briefing.house is not None
    assert knowing.briefing.labels == stage.label_kinds
    assert not human.observed[0].truth
    assert human.briefing.labels == ()


@pytest.mark.parametrize("where", ["begin", "act", "answer"])
def test_a_mind_that_fails_is_retired_and_the_trial_goes_on(where: str) -> None:
    class Bad(Mind):
        def begin(self, briefing: Briefing) -> None:
            if where == "begin":
                raise ValueError("no such house")

        def act(self, observation: Observation) -> Action:
            if observation.tick < 7:
                return Action()
            if where == "answer":
                return "forward"  # type: ignore[return-value]
            raise ValueError("lost")

    log = run(Stage(seen=30), Mind(), Bad())
    assert log.met
    assert [(fault.seat, fault.tick) for fault in log.faults] == [("robot", 0 if where == "begin" else 7)]
    assert "fault" in kinds(log)
    assert {"begin": "no such house", "act": "lost", "answer": "must return an hthor.types.Action"}[
        where
    ] in log.faults[0].detail
    assert len(log.paths["robot"]) == len(log.paths[HUMAN])


class Counting(ObjectGoalNavigation):
    """Counts how often it is asked; a tenth of the goal is met after every twelve ticks."""

    asked = 0

    def progress(self, task: TaskSpec, snapshot: Snapshot, house: object = None) -> float:
        self.asked += 1
        return snapshot.tick // 12 / 10


@pytest.fixture
def counting(monkeypatch: pytest.MonkeyPatch) -> Counting:
    kind = Counting()
    monkeypatch.setattr(plugins, "load", lambda sort, name: kind)
    return kind


def test_progress_is_noticed_within_a_second_and_whole_in_the_end(counting: Counting) -> None:
    log = run(Stage(seen=47), Mind(), Mind())
    steps = [(event.tick, event.value) for event in log.events if event.kind == "progress"]
    assert steps == [(20, 0.1), (30, 0.2), (40, 0.3), (47, 1.0)]
    assert log.progress == 1.0
    assert counting.asked == 5, "at the start and once a second, for no thing has changed"


@pytest.mark.usefixtures("counting")
def test_an_episode_knows_its_progress_while_it_goes_on() -> None:
    episode, shares = Episode(trial(), Stage(seen=47)), []
    episode.reset()
    while not episode.done:
        shares.append(episode.progress)
        episode.advance()
    assert [shares[tick] for tick in (0, 19, 20, 30, 40)] == [0.0, 0.0, 0.1, 0.2, 0.3]
    assert episode.progress == 1.0


def test_progress_is_noticed_at_once_when_a_thing_changes(counting: Counting) -> None:
    class Restless(Stage):
        def advance(self) -> tuple[Event, ...]:
            self.tick += 1
            self.things = dict(self.things)
            return (Placed(tick=self.tick, seat="robot", object="apple", on="table"),) if self.tick == 13 else ()

    stage = Restless(seen=30)
    assert [event.tick for event in run(stage, Mind(), Mind()).events if event.kind == "progress"] == [12, 24, 30]
    stage.carrying = True
    ticks = [event.tick for event in run(stage, Mind(), Mind()).events if event.kind == "progress"]
    assert ticks == [13, 30], "what is only carried along can wait, a deed cannot"


def test_a_kind_that_counts_no_parts_has_no_progress() -> None:
    log = run(Stage(seen=20), Mind(), Mind())
    assert log.progress is None
    assert "progress" not in kinds(log)


def test_waiting_is_idle_and_moving_is_not() -> None:
    def script(now: Observation) -> Action:
        return Action(motion=Move(forward=0.1) if now.tick < 20 else Wait(seconds=0.5))

    log = run(Stage(seen=50, busy=5), Mind(script), Mind(lambda _: Action(motion=Move(forward=0.5))))
    assert log.idle == {HUMAN: 30, "robot": 0}


def test_what_is_refused_leaves_the_body_idle() -> None:
    class Stubborn(Stage):
        def start(self, seat: str, motion: Motion) -> None:
            self.started.append((self.tick, seat, motion))

    log = run(Stubborn(seen=12), Mind(lambda _: Action(motion=Move(forward=0.1))), None)
    assert log.idle == {HUMAN: 12}


def test_a_retired_robot_is_idle_from_then_on() -> None:
    def fail(now: Observation) -> Action:
        if now.tick >= 7:
            raise ValueError("lost")
        return Action(motion=Move(forward=0.1))

    assert run(Stage(seen=30), Mind(), Mind(fail)).idle["robot"] == 23


def test_the_log_knows_how_far_a_claim_is_off_and_nobody_else_does() -> None:
    claims = {0: ((0.3, 0.4, 0.0), "apple"), 1: ((9.0, 0.0, 0.0), "apple"), 2: (None, "apple"), 3: (None, "ghost")}

    def script(now: Observation) -> Action:
        position, name = claims.get(now.tick, (None, ""))
        return Action(say=Send(text="there", object=name, position=position) if name else None)

    human, robot = Mind(), Mind(script)
    log = run(Stage(seen=9), human, robot)
    sent = [event for event in log.events if event.kind == "sent"]
    assert [event.off for event in sent] == [0.5, 9.0, UNSET, None]
    assert not any(hasattr(message, "off") for seen in human.observed for message in seen.inbox)


def test_a_failing_human_model_is_not_hidden() -> None:
    def fail(_: Observation) -> Action:
        raise RuntimeError("broken model")

    with pytest.raises(RuntimeError, match="broken model"):
        run(Stage(), Mind(fail), Mind())
