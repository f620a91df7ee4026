"""The human proxy's laws: the same person every time, blind to robots until one speaks, who gets tasks done."""

from __future__ import annotations

import math
from itertools import pairwise

import pytest
from fake_flat import BODY, DOORWAY, FURNITURE, Flat, play
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from law_cases import cases

from hthor import catalog, plugins, rules, seeds
from hthor.humans.communication.trust import Experience, Trust, initial_trust
from hthor.humans.memory import location_priors
from hthor.humans.memory.spatial_memory import SpatialMemory
from hthor.humans.models.proxy import Model
from hthor.humans.population import participant
from hthor.humans.population.parameters import Parameters
from hthor.humans.population.participant import Participant
from hthor.types import HUMAN, Action, Detection, Message, Move, Observation, Outcome, Pick, Pose, Receipt, Rotate

TRAITS = Parameters()
ROBOT = Detection(
    id="robot", kind="scout", family="robot", position=(3.0, 1.5, 0.5), size=(0.4, 0.4, 1.0), yaw=0.0, distance=2.0
)


def trial(flat, person=0, state=None, ticks=900, say=None, until=None, **task):
    """One trial of a person in a flat: the model, the poses, what was said."""
    model = Model(Participant(seed=1, number=person), state)
    model.begin(flat.briefing(**task))
    trace, said = play(model, flat, ticks=ticks, until=until, say=say)
    return model, trace, said


def message(number=0, position=None, thing="apple"):
    return Message(id=number, sender="robot", tick=0, text="I see it", object=thing, position=position)


# ---------------------------------------------------------------------------------------------------------- the person


def test_the_same_person_does_the_same():
    assert trial(Flat(), 3)[1] == trial(Flat(), 3)[1]


def test_people_differ():
    assert trial(Flat(), 3, ticks=200)[1] != trial(Flat(), 4, ticks=200)[1]


def test_silent_robots_change_nothing():
    alone, watched = Flat("Fridge|1"), Flat("Fridge|1")
    watched.extra = (ROBOT,)
    assert trial(alone)[1] == trial(watched, teammates=("robot", "robot2"))[1]


def test_a_person_continues_from_their_state():
    first, _, _ = trial(Flat(), ticks=300, teammates=("robot",))
    first.rate(True, 300)
    flat_a, flat_b = Flat("Sofa|1"), Flat("Sofa|1")
    first.begin(flat_a.briefing())
    trace, _ = play(first, flat_a, ticks=200)
    assert (
        trace == trial(flat_b, state={"trials": 1, "alpha": first.trust.alpha, "beta": first.trust.beta}, ticks=200)[1]
    )


def test_traits_are_spread_around_the_population():
    paces = [participant.add_random_effects(TRAITS, seeds.derive(0, k)).v_pace for k in range(400)]
    logs = [math.log(pace / TRAITS.v_pace) for pace in paces]
    assert abs(sum(logs) / 400) < 0.03
    assert math.sqrt(sum(value * value for value in logs) / 400) == pytest.approx(0.5 * TRAITS.sigma, rel=0.15)


def test_practice_makes_brisk():
    paces = [participant.with_practice(TRAITS, index).v_pace for index in range(10)]
    assert paces == sorted(paces)
    assert paces[0] == TRAITS.v_pace
    assert paces[-1] < TRAITS.v_pace * (1 + TRAITS.learn)


@pytest.mark.parametrize("name", sorted(set(plugins.names("human model")) - {"live", "recorded", "replay"}))
def test_every_model_follows_the_seam(name):
    model = plugins.load("human model", name)(Participant(seed=0, number=0))
    flat = Flat()
    model.begin(flat.briefing(teammates=("robot",)))
    assert isinstance(model.act(flat.observation()), Action)
    assert model.rate(False, 900) in range(rules.TRUST_MIN, rules.TRUST_MAX + 1)
    model.begin(flat.briefing())
    assert model.rate(True, 10) is None
    assert dict(model.state())


# ----------------------------------------------------------------------------------------------------------- the tasks


@pytest.mark.parametrize("support", FURNITURE)
def test_finds_the_target(support):
    flat = Flat(support)
    trial(flat, until=flat.found)
    assert flat.found()


def test_keeps_looking_at_what_was_found():
    flat = Flat("Bed|1")
    model, _, _ = trial(flat, until=flat.found)
    play(model, flat, ticks=60)
    assert flat.found()


@pytest.mark.parametrize(
    ("support", "destination", "place"), [("Bed|1", "fridge", "Fridge|1"), ("Fridge|1", "sofa", "Sofa|1")]
)
def test_carries_the_target_where_it_belongs(support, destination, place):
    flat = Flat(support)
    relation = catalog.kind(destination).relation
    trial(
        flat,
        relation=relation,
        destination=destination,
        until=lambda: flat.support == place and not flat.held,
    )
    assert flat.support == place
    assert not flat.held


def test_walks_at_their_pace():
    flat = Flat("Bed|1")
    model, trace, _ = trial(flat, until=flat.found)
    steps = [math.dist(a[:2], b[:2]) for a, b in pairwise(trace)]
    moving = [step for step in steps if step > 1e-6]
    assert max(moving) <= model.traits.v_pace * 0.1 + 1e-9
    assert sorted(moving)[len(moving) // 2] == pytest.approx(model.traits.v_pace * 0.1)


def test_goes_round_a_robot_that_stands_in_the_doorway_side():
    flat = Flat("Bed|1", robot=(5.05, 2.35))
    trial(flat, until=flat.found)
    assert flat.found()


def test_waits_for_a_robot_and_goes_on_when_it_left():
    flat = Flat("Bed|1", robot=(5.05, 2.0))
    model, trace, _ = trial(flat, ticks=300)
    assert max(x for x, _, _ in trace) < 5.05
    flat.robot = None
    play(model, flat, until=flat.found)
    assert flat.found()


# -------------------------------------------------------------------------------------------------------------- robots


def believed(position, support="Fridge|1", until=None, ticks=900):
    """A person who accepts a message of tick 25; tries people until one does."""
    for person in range(9):
        flat = Flat(support)
        known = []

        def say(tick, known=known):
            return (message(position=position),) if tick >= 25 and not known else ()

        def stop(flat=flat):
            return until is not None and until(flat)

        model = Model(Participant(seed=1, number=person))
        model.begin(flat.briefing(teammates=("robot",)))
        said = []
        while flat.tick < ticks and not stop():
            said += play(model, flat, ticks=1, say=say)[1]
            known[:] = [reply for _, reply in said]
        if said and said[0][1].accept:
            return model, flat, said
    raise AssertionError("nobody accepted")


def test_goes_where_a_accepted_message_says():
    model, flat, _ = believed(Flat("Bed|1").apple, "Bed|1", until=Flat.found)
    assert flat.found()
    before = model.trust.mean
    model.rate(True, flat.tick)
    assert model.trust.mean > before


def test_a_message_that_misleads_costs_trust_and_the_search_goes_on():
    model, flat, _ = believed((9.5, 1.6, 0.5), "Fridge|1", until=Flat.found)
    assert flat.found()
    assert model.trust.mean < initial_trust(model.traits).mean
    before = model.trust.mean
    model.rate(True, flat.tick)
    assert model.trust.mean < before


def test_declines_what_they_hold():
    for person in range(6):
        flat = Flat("Table|1")
        model, _, _ = trial(flat, person, relation="on", destination="bed", until=lambda flat=flat: flat.held)
        _, said = play(model, flat, ticks=60, say=lambda tick: (message(position=(9.0, 2.0, 0.5)),))
        assert not any(reply.accept for _, reply in said)


def test_trust_has_no_say_without_robots():
    model, _, _ = trial(Flat(), ticks=5)
    before = model.trust
    assert model.rate(True, 5) is None
    assert model.trust == before


# ---------------------------------------------------------------------------------------------------- trust and belief


@given(
    st.lists(st.tuples(st.booleans(), st.none() | st.floats(0, 90), st.booleans(), st.booleans()), max_size=12),
    st.floats(-6, 6),
)
def test_trust_stays_on_its_scale(trials, noise):
    trust = initial_trust(TRAITS)
    for offered, helped, misled, met in trials:
        signal = Experience(offered=offered, helped=helped, misled=misled).signal(met, TRAITS)
        assert 0.0 <= signal <= 1.0
        trust = trust.after(signal, TRAITS)
        assert 0.0 < trust.mean < 1.0
    assert rules.TRUST_MIN <= trust.report(noise, TRAITS) <= rules.TRUST_MAX


@given(st.floats(0.01, 50), st.floats(0.01, 50), st.floats(0, 1), st.floats(0, 1))
def test_better_help_makes_for_more_trust(alpha, beta, a, b):
    worse, better = sorted((a, b))
    trust = Trust(alpha=alpha, beta=beta)
    assert trust.after(worse, TRAITS).mean <= trust.after(better, TRAITS).mean + 1e-12
    assert trust.after(0.0, TRAITS).mean <= trust.mean <= trust.after(1.0, TRAITS).mean


def test_early_help_is_worth_more_and_failure_tells():
    early, late = Experience(offered=True, helped=5.0), Experience(offered=True, helped=60.0)
    assert early.signal(True, TRAITS) > late.signal(True, TRAITS) > Experience(offered=True).signal(True, TRAITS)
    assert early.signal(True, TRAITS) > early.signal(False, TRAITS)


@pytest.mark.parametrize("target", [*catalog.TARGETS, "unheard_of"])
def test_beliefs_add_up(target):
    assert sum(location_priors.prior_shares(target).values()) == pytest.approx(1.0)
    expected = location_priors.location_belief(target, 0.6)
    assert sum(expected.values()) == pytest.approx(1.0)
    assert min(expected.values()) > 0.0


def test_a_doorway_seen_from_both_sides_leads_nowhere_new():
    memory = SpatialMemory(tau=1000.0)
    memory.keep_doorway(DOORWAY, (3.0, 2.0), "kitchen")
    doorway = memory.doorways[DOORWAY.id]
    assert not doorway.explored
    assert doorway.beyond[0] > 5.05
    memory.keep_doorway(DOORWAY, (7.0, 2.0), "living")
    assert doorway.explored


def test_walking_through_a_doorway_is_remembered():
    memory = SpatialMemory(tau=1000.0)
    assert memory.visit((4.0, 2.0), "")
    memory.keep_doorway(DOORWAY, (4.0, 2.0), "")
    assert not memory.visit((5.0, 2.0), "")
    assert not memory.doorways[DOORWAY.id].explored
    memory.visit((5.2, 2.0), "")
    assert memory.doorways[DOORWAY.id].explored


# ---------------------------------------------------------------------------------------------------------- robustness

coordinate = st.floats(0.3, 4.7)
moment = st.fixed_dictionaries(
    {
        "x": coordinate,
        "y": coordinate,
        "yaw": st.floats(-3.1, 3.1),
        "pitch": st.floats(-1.0, 1.0),
        "room": st.sampled_from(("", "kitchen", "living")),
        "holding": st.sampled_from(("", "apple", "mug")),
        "idle": st.booleans(),
        "outcome": st.sampled_from(
            (
                None,
                *(
                    Outcome(motion=motion, ok=ok, reason="no", by=by)
                    for motion in ("move", "pick", "place", "open")
                    for ok in (True, False)
                    for by in ("", "robot", "Table|1")
                ),
            )
        ),
        "mail": st.sampled_from(
            ((), (message(1, (1.0, 1.0, 1.0)),), (message(2),), (message(3, (99.0, -99.0, 0.0), "bed"),))
        ),
    }
)


@settings(max_examples=cases(15), suppress_health_check=[HealthCheck.too_slow])
@given(st.sampled_from(("find", "on", "in")), st.lists(moment, min_size=1, max_size=40))
def test_nothing_perceived_makes_a_person_fall_over(relation, moments):
    flat = Flat("Table|1")
    flat.extra = (ROBOT,)
    model = Model(Participant(seed=0, number=0))
    model.begin(flat.briefing(relation=relation, destination="" if relation == "find" else "fridge"))
    for number, now in enumerate(moments):
        flat.pose = Pose(x=now["x"], y=now["y"], yaw=now["yaw"], pitch=now["pitch"])
        action = model.act(
            Observation(
                tick=number * 7,
                pose=flat.pose,
                idle=now["idle"],
                senses=flat,
                room=now["room"],
                holding=now["holding"],
                outcome=now["outcome"],
                inbox=now["mail"],
                receipt=Receipt(message=0, status="shown", tick=0),
            )
        )
        if isinstance(action.motion, Move):
            assert math.hypot(action.motion.forward, action.motion.left) <= rules.MOVE_MAX_M
        if isinstance(action.motion, Rotate):
            assert abs(flat.pose.pitch + action.motion.pitch) <= BODY.pitch_limit + 1e-9
        if isinstance(action.motion, Pick):
            assert action.motion.object == "apple"
    assert HUMAN == "human"
