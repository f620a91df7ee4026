"""Other minds in a person's place: one contract for every human model; greedy, random and replayed people."""

from __future__ import annotations

import math
from pathlib import Path

import msgspec
import pytest
import world_house as tiny
from event_fakes import fields
from fake_flat import Flat, play
from world_house import COFFEE, COUNTER, on

from hthor import episode as umpire
from hthor import plugins, rules
from hthor.errors import HthorError
from hthor.eval.records import trial_record
from hthor.humans.models import _logged_trials, greedy, proxy, random, replay
from hthor.humans.population.parameters import Parameters
from hthor.humans.population.participant import Participant
from hthor.tasks.suite import make_suite
from hthor.tasks.suites import library
from hthor.trials import sessions
from hthor.types import (
    HUMAN,
    Action,
    AgentRef,
    Goal,
    HumanSeat,
    Message,
    Move,
    Pose,
    RobotSeat,
    Send,
    TaskSpec,
    TrialSpec,
    Wait,
)
from hthor.world import World

EXAMPLES = Path(__file__).parents[2] / "examples"
SEAT = RobotSeat(seat="robot", robot="scout", agent=AgentRef(name="teller", source="", sha256=""))
QUICK = msgspec.structs.replace(Parameters(), lam0=3.0, v_pace=0.9, t_manip=1.0, p_fail=0.0)


class Teller:
    """A robot's mind that says one thing at tick 20, and otherwise stands there."""

    def __init__(self, *says: Send, at: int = 20) -> None:
        self.says, self.at = list(says), at

    def begin(self, briefing):
        self.left = list(self.says)

    def act(self, observation):
        due = self.left and observation.tick >= self.at
        return Action(motion=Wait(), say=self.left.pop(0) if due else None)


class Raises:
    """Hidden state: touching it in any way is an error."""

    def __getattribute__(self, name):
        raise AssertionError(f"a person looked at what nobody can perceive: {name}")

    __iter__ = __len__ = __bool__ = __getitem__ = lambda self, *_: Raises.__getattribute__(self, "it")


class Known(Flat):
    """A flat whose truth raises on access."""

    def briefing(self, **task):
        return msgspec.structs.replace(super().briefing(**task), house=Raises())

    def observation(self, idle=True):
        return msgspec.structs.replace(super().observation(idle), truth=Raises())


BED = "bed|1"
FROM = (BED, COFFEE)
"""Where the apple lies in the two trials of a session."""


def bring(support: str = BED, start: Pose | None = None, **changes) -> TaskSpec:
    """Bring the apple from the living room of the tiny house to the dining table, where the person begins."""
    plain = tiny.task(on(support, "apple"), human=start, robots=(Pose(x=9.4, y=1.0),))
    goal = Goal(target="apple", relation="on", destination="dining_table")
    made = msgspec.structs.replace(plain, kind="mobile_manipulation", goal=goal, instruction="Bring the apple.")
    return msgspec.structs.replace(made, **changes)


def spec(task: TaskSpec, robots=(SEAT,), participant: int = 0, index: int = 0) -> TrialSpec:
    humans = (HumanSeat(seat=HUMAN, model="proxy", sha256="0", participant=participant),)
    hashes = dict.fromkeys(("suite_sha256", "rules_sha256", "code_sha256"), "0")
    return TrialSpec(task=task, robots=robots, humans=humans, session=participant, index=index, seed=0, **hashes)


@pytest.fixture(scope="module")
def world() -> World:
    return World(tiny.house(), robots=("scout",), objects=[("apple", "apple")])


@pytest.fixture(scope="module")
def log(world, tmp_path_factory) -> Path:
    """The log of a run of one person and two trials, with a robot that says where the apple is."""
    folder = tmp_path_factory.mktemp("run")
    person = proxy.Model(Participant(seed=0, number=0, traits=msgspec.structs.replace(QUICK, a0=9.0)))
    lines = b""
    for index, support in enumerate(FROM):
        trial = spec(bring(support), index=index)
        done = umpire.play(
            trial, world, {"human": person}, {"robot": Teller(Send(text="Here.", object="apple", position=at(support)))}
        )
        assert done.met
        assert done.ratings[HUMAN] is not None
        lines += trial_record.encode(trial_record.make_record(trial, done))
    (folder / "trials.jsonl").write_bytes(lines)
    return folder


def at(support: str):
    return on(support, "apple").position


def model(name: str, log: Path, state=None, participant: int = 0, traits: Parameters = QUICK):
    """A person of any human model there is, by its name or its file."""
    made = plugins.load("human model", name)
    person = Participant(seed=0, number=participant, traits=traits)
    return made(person, state, str(log)) if name == "replay" else made(person, state)


@pytest.fixture(autouse=True)
def offline(monkeypatch, tmp_path):
    """Whoever asks a language model asks a rule."""
    monkeypatch.setenv("HTHOR_LLM_URL", "stub")
    monkeypatch.setenv("HTHOR_LLM_CACHE", str(tmp_path / "answers.jsonl"))


MODELS = (
    *(name for name in plugins.names("human model") if name not in ("live", "recorded")),
    str(EXAMPLES / "llm_person.py"),
    str(EXAMPLES / "cloned_person.py"),
)
FREE = tuple(name for name in MODELS if name != "replay")

# -------------------------------------------------------------------------------------------------- every human model


@pytest.mark.parametrize("name", MODELS)
def test_plays_whole_trials_in_the_real_world_the_same_twice(name, world, log):
    def session_(state=None):
        person, found = model(name, log, state), []
        for index, support in enumerate(FROM):
            trial = spec(bring(support), index=index)
            done = umpire.play(
                trial,
                world,
                {"human": person},
                {"robot": Teller(Send(text="Here.", object="apple", position=at(support)))},
            )
            assert done.ratings[HUMAN] in range(rules.TRUST_MIN, rules.TRUST_MAX + 1)
            found.append(trial_record.encode(trial_record.make_record(trial, done)))
        return person, found

    (person, first), (_, second) = session_(), session_()
    assert first == second
    assert person.state()["trials"] == 2


@pytest.mark.parametrize("name", MODELS)
def test_goes_on_from_its_state_as_if_never_interrupted(name, world, log):
    def second(person):
        return umpire.play(spec(bring(COFFEE), index=1), world, {"human": person}, {"robot": Teller()})

    whole = model(name, log)
    umpire.play(
        spec(bring(BED)),
        world,
        {"human": whole},
        {"robot": Teller(Send(text="Here.", object="apple", position=at(BED)))},
    )
    state = msgspec.json.decode(msgspec.json.encode(whole.state()))
    assert second(whole) == second(model(name, log, state))


@pytest.mark.parametrize("name", FREE)
def test_perceives_and_nothing_else(name, log):
    person, flat = model(name, log), Known("Sofa|1")
    person.begin(flat.briefing(relation="on", destination="dining_table", teammates=("robot",)))

    def say(tick):
        return (
            (Message(id=0, sender="robot", tick=20, text="Here.", object="apple", position=flat.apple),)
            if 20 <= tick < 60
            else ()
        )

    trace, _ = play(person, flat, say=say)
    assert math.dist(trace[0][:2], trace[-1][:2]) > 0.0 or flat.support == "Table|1"
    assert person.rate(False, 900) in range(rules.TRUST_MIN, rules.TRUST_MAX + 1)


@pytest.mark.parametrize("name", FREE)
def test_rates_no_robot_that_is_not_there(name, log):
    person, flat = model(name, log), Flat()
    person.begin(flat.briefing())
    play(person, flat, ticks=10)
    assert person.rate(True, 10) is None


# --------------------------------------------------------------------------------------------------- greedy and random


SUITES = ("navigation", "manipulation", "tidy", "rearrange", "collect", "carry", "vln")


def elder_task(suite: str) -> TaskSpec:
    return next(task for task in library.load_suite(suite).tasks if task.house == "elder")


@pytest.fixture(scope="module")
def elder() -> World:
    """One world for a task of every kind: it holds every object that any of them has."""
    objects = {placed.id: placed.kind for suite in SUITES for placed in elder_task(suite).objects}
    return World("elder", robots=("tender",), objects=tuple(sorted(objects.items())))


@pytest.mark.parametrize("suite", SUITES)
def test_both_ends_play_every_kind_of_task(suite, elder):
    from hthor.trials import TrialRunner

    task = msgspec.structs.replace(elder_task(suite), time_limit=30.0, phases=())
    one = sessions.make_sessions(make_suite("one", 1, (task,)), agent="oracle", robot="tender", humans="greedy")[0]
    stage = TrialRunner()
    for made in (greedy.Model, random.Model):
        with stage.enter(one) as company:
            company.humans[HUMAN] = made(Participant(seed=0, number=0, traits=QUICK))
            done = stage.run(company, one.trials[0], elder).log
        assert done.met or done.ticks == round(task.time_limit / rules.TICK_S)
        assert not done.faults
        answers = {event.kind for event in done.events if event.kind in ("accepted", "declined")}
        assert answers <= ({"accepted"} if made is greedy.Model else {"declined"})


def test_greedy_people_are_all_the_same_and_ratings_do_not_move():
    def go(participant, trials):
        person, flat = (
            greedy.Model(Participant(seed=participant, number=participant, traits=QUICK)),
            Flat("Fridge|1"),
        )
        for _ in range(trials):
            flat = Flat("Fridge|1")
            person.begin(flat.briefing(teammates=("robot",)))
            trace, _ = play(person, flat, until=flat.found)
            rating = person.rate(True, flat.tick)
        return trace, rating

    assert go(0, 1) == go(7, 1) == go(3, 2)


def test_greedy_people_notice_within_three_metres_and_never_beyond():
    person, flat = greedy.Model(Participant(seed=0, number=0, traits=QUICK)), Flat("Bed|1")
    person.begin(flat.briefing())

    def noticed():
        return person._objects.known["apple"].seen is not None

    play(person, flat, until=noticed)
    eye = (flat.pose.x, flat.pose.y, 1.6)
    assert noticed()
    assert greedy.SIGHT_M - 0.5 < math.dist(eye, flat.apple) <= greedy.SIGHT_M + 0.2


@pytest.mark.parametrize(("made", "answers"), [(greedy.Model, {True}), (random.Model, {False})])
def test_the_ends_always_and_never_accept(made, answers):
    for participant in range(2):
        person, flat = made(Participant(seed=2, number=participant, traits=QUICK)), Flat("Fridge|1")
        person.begin(flat.briefing(teammates=("robot",)))
        texts = ("It is here.", "Come to the sofa.")

        def say(tick, texts=texts):
            number = (tick - 20) // 200
            if tick < 20 or number >= len(texts):
                return ()
            return (
                Message(
                    id=number,
                    sender="robot",
                    tick=0,
                    text=texts[number],
                    object="apple",
                    position=(9.0, 0.6 + number, 0.5),
                ),
            )

        _, said = play(person, flat, ticks=430, say=say)
        assert {reply.accept for _, reply in said} == answers
        assert len({reply.message for _, reply in said}) == 2


def test_random_people_choose_each_option_as_often():
    from hthor.humans.core.policy import OptionDescription, Situation

    def option(name, value):
        return OptionDescription(
            name=name, text="", verb="search", kind="bed", knowledge=value, uniform=0.1, metres=1 / value, seconds=2.0,
            exposure=0.0, closed=False, value=value,
        )  # fmt: skip

    options = tuple(option(f"Bed|{k}", 10.0**-k) for k in range(4))
    counts = [0] * 4
    for root in range(2000):
        situation = Situation(
            instruction="", aim="target", number=root % 7, left=9.0, room="", holding="", options=options
        )
        counts[random.RandomPolicy(root).choose(situation)] += 1
    assert max(abs(count - 500) for count in counts) < 4.5 * math.sqrt(2000 * 0.25 * 0.75)


# -------------------------------------------------------------------------------------------------------------- replay


def paths(done):
    return done.paths["human"]


def deeds(done):
    kinds = ("picked", "placed", "opened", "accepted", "declined", "displayed", "success")
    return [
        (event.tick, event.kind, fields(event))
        for event in done.events
        if event.seat == "human" and event.kind in kinds
    ]


@pytest.mark.parametrize("robot", ["same", "silent"])
def test_a_replay_does_the_same_whatever_the_robot_says(robot, world, log):
    past_ = _logged_trials.read_logged_trials(str(log))[0]
    person = model("replay", log)
    for one, support in zip(past_, FROM, strict=True):
        says = [Send(text="Here.", object="apple", position=at(support))] if robot == "same" else []
        done = umpire.play(one.spec, world, {"human": person}, {"robot": Teller(*says)})
        assert paths(done) == one.paths["human"]
        wanted = [(e.tick, e.kind, fields(e)) for e in one.events if e.seat == "human"]
        answered = {"accepted", "displayed", "shown"} if robot == "silent" else set()
        assert [deed for deed in wanted if deed[1] not in answered | {"shown"}] == deeds(done)
        assert done.ratings == one.ratings
        assert done.met


def test_a_replay_answers_what_is_shown_when_the_logged_person_answered(world, log):
    one = _logged_trials.read_logged_trials(str(log))[0][0]
    (tick, accept), *_ = one.utterances()
    says = (Send(text="Look here.", object="apple", position=(9.0, 2.7, 0.5)), Send(text="Or here.", object="apple"))
    done = umpire.play(one.spec, world, {"human": model("replay", log)}, {"robot": Teller(*says, at=tick - 1)})
    answered = [event for event in done.events if event.kind in ("accepted", "declined")]
    assert [(event.tick, event.kind == "accepted") for event in answered] == [(tick, accept)]


class Blocker(Teller):
    """Stands where it starts until a tick, then goes aside."""

    def act(self, observation):
        stays = observation.tick < self.at or observation.pose.y > 3.4
        return Action(motion=Wait() if stays else Move(forward=0.5))


def test_a_replay_waits_for_a_robot_in_its_way_and_catches_up(world, log):
    one = _logged_trials.read_logged_trials(str(log))[0][0]
    x, y, _ = next(pose for pose in one.paths["human"] if pose[0] > 5700)
    start = Pose(x=x / 1000.0, y=y / 1000.0, yaw=math.pi / 2)
    task = msgspec.structs.replace(one.spec.task, robot_starts=(start,))
    done = umpire.play(spec(task), world, {"human": model("replay", log)}, {"robot": Blocker(at=one.ticks)})
    assert [kind for _, kind, _ in deeds(done) if kind != "accepted"] == ["picked", "placed", "success"]
    assert done.ticks > one.ticks
    blocked = umpire.play(spec(task), world, {"human": model("replay", log)}, {"robot": Blocker(at=10_000)})
    assert not blocked.met
    assert blocked.ticks == 900
    assert max(p[0] for p in paths(blocked)) < 1000 * start.x


def test_a_replay_stands_still_after_the_end_of_its_log(world, log):
    one = _logged_trials.read_logged_trials(str(log))[0][0]
    task = msgspec.structs.replace(one.spec.task, objects=(on(COUNTER, "apple"),))  # it lies somewhere else now
    done = umpire.play(spec(task), world, {"human": model("replay", log)}, {"robot": Teller()})
    assert not done.met
    assert done.ticks == 900
    assert len(set(paths(done)[one.ticks // 2 + 2 :])) == 1


@pytest.mark.parametrize(
    ("task", "participant", "words"),
    [
        (bring(BED, instruction="Find the apple."), 0, "did no such task as 'Find the apple.'"),
        (bring(BED, start=Pose(x=3.0, y=2.0)), 0, "from this place"),
        (bring(BED), 5, "has no participant 5; it holds 0"),
    ],
)
def test_a_log_of_another_task_is_an_error_that_says_so(task, participant, words, world, log):
    with pytest.raises(HthorError) as error:
        umpire.play(
            spec(task, participant=participant),
            world,
            {"human": model("replay", log, participant=participant)},
            {"robot": Teller()},
        )
    assert words in str(error.value)
    assert "that run's" in str(error.value)


@pytest.mark.parametrize(
    ("content", "words"), [(None, "there is no log"), (b"{}\n", "line 1"), (b"", "has no complete trial")]
)
def test_a_log_that_cannot_be_read_is_an_error(content, words, tmp_path):
    file = tmp_path / "trials.jsonl"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(HthorError, match=words):
        replay.Model(Participant(seed=0, number=0), None, str(tmp_path))


def test_replay_without_a_run_says_how_to_name_one():
    with pytest.raises(HthorError, match="--humans replay:RUN"):
        replay.Model(Participant(seed=0, number=0))


def test_the_hash_of_a_replay_is_that_of_its_log(log, tmp_path):
    first = replay.ingredients(str(log))
    copy = tmp_path / "trials.jsonl"
    copy.write_bytes((log / "trials.jsonl").read_bytes())
    assert replay.ingredients(str(copy)) == first
    copy.write_bytes(copy.read_bytes().splitlines(keepends=True)[0])
    assert replay.ingredients(str(copy)) != first
