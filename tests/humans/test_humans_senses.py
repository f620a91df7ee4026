"""How people notice and forget: what the world shows of a thing, the law of glimpses, leaking memory, the journal."""

from __future__ import annotations

import math
from types import SimpleNamespace

import msgspec
import numpy as np
import pytest
import world_house as tiny
from fake_flat import BODY, FURNITURE, Flat, play
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases
from random_solids import house, slowly
from world_house import COFFEE, FRIDGE, TABLE, do, on, task, wait

from hthor import seeds
from hthor.errors import StaleObservation
from hthor.humans.core.trial_context import HumanContext
from hthor.humans.memory.object_memory import ObjectMemory
from hthor.humans.memory.spatial_memory import SpatialMemory
from hthor.humans.models.proxy import Model
from hthor.humans.perception.detection_rate import Head, PlaceDetection, apparent_size, detection_rate, expected_size
from hthor.humans.perception.exposure_log import ExposureLog, Glimpse
from hthor.humans.perception.perception import Eyes
from hthor.humans.population.parameters import Parameters
from hthor.humans.population.participant import Participant
from hthor.types import HUMAN, Briefing, Detection, Job, Observation, Open, Pose, Sighting
from hthor.world import World
from hthor.world.model.bodies import avatar
from hthor.world.perception import occlusion_kernel, view_frustum
from hthor.world.perception.occluders import Occluders

TRAITS = Parameters()
angle, ecc, share, beside = st.floats(1e-3, 1.0), st.floats(0.0, 1.5), st.floats(0.0, 1.0), st.integers(0, 20)


# ------------------------------------------------------------------------------------------------- the law of glimpses


@given(angle, angle, ecc, ecc, share, share, beside, beside)
def test_better_seen_is_noticed_faster(a, b, near, aside, less, more, few, many):
    (a, b), (near, aside), (less, more), (few, many) = map(sorted, ((a, b), (near, aside), (less, more), (few, many)))
    most = detection_rate(TRAITS, b, near, more, few)
    assert 0.0 <= most <= TRAITS.lam0
    for other in ((a, near, more, few), (b, aside, more, few), (b, near, less, few), (b, near, more, many)):
        assert detection_rate(TRAITS, *other) <= most


def test_the_rate_halves_where_the_parameters_say():
    full = detection_rate(TRAITS, 1e9, 0.0)
    assert full == pytest.approx(TRAITS.lam0)
    assert detection_rate(TRAITS, TRAITS.a50, 0.0) == pytest.approx(full / 2)
    assert detection_rate(TRAITS, 1e9, TRAITS.ecc_sd) == pytest.approx(full * math.exp(-0.5))
    assert detection_rate(TRAITS, 1e9, 0.0, share=0.25, beside=3) == pytest.approx(
        full * 0.25 * math.exp(-3 * TRAITS.clutter)
    )


def test_eccentricity_counts_up_and_down_as_well():
    head = Head(Pose(x=0.0, y=0.0, yaw=math.pi / 2, pitch=-0.5), 1.6)
    for point, off in (
        ((0.0, 1.0, 1.6 + math.tan(-0.5)), 0.0),
        ((0.0, 1.0, 1.6), 0.5),
        ((0.0, -1.0, 1.6), math.pi - 0.5),
    ):
        far, aside = head.to(point)
        assert far == pytest.approx(math.dist((0.0, 0.0, 1.6), point))
        assert aside == pytest.approx(off, abs=1e-6)


@given(
    st.floats(-3, 3), st.floats(-3, 3), st.floats(0, 2), st.floats(-3.1, 3.1), st.floats(-1, 1), st.floats(0.03, 0.3)
)
def test_the_rate_at_a_place_is_that_of_a_thing_alone_there_in_full_view(x, y, z, yaw, pitch, size):
    head = Head(Pose(x=0.0, y=0.0, yaw=yaw, pitch=pitch), 1.6)
    far, ecc = head.to((x, y, z))
    found = PlaceDetection(TRAITS, size).rate(head, (x, y, z))
    assert found == pytest.approx(detection_rate(TRAITS, size / far, ecc), rel=1e-6, abs=1e-12)


def test_people_know_how_large_things_are():
    assert expected_size("apple_2") == pytest.approx(0.08)
    assert (
        expected_size("book")
        == pytest.approx(math.sqrt(0.15 * 0.21))
        == pytest.approx(apparent_size((0.21, 0.03, 0.15)))
    )
    assert expected_size("heirloom|7") > 0.0


# --------------------------------------------------------------------------------------------- what the world's eye has


@settings(max_examples=cases(30))
@given(st.integers(0, 10**6), st.floats(-3.1, 3.1), st.floats(-0.6, 0.4))
def test_a_closer_look_finds_what_ray_after_ray_finds(seed, yaw, pitch):
    chance, scene = np.random.default_rng(seed + 5), house(seed, 60, 0.7)
    count = 24
    ahead = yaw + chance.uniform(-0.9, 0.9)
    middle = np.array([0.1, -0.2, 1.0]) + chance.uniform(0.3, 4.0) * np.array([math.cos(ahead), math.sin(ahead), 0.0])
    others = middle + chance.normal(0.0, 0.4, (count, 3))
    size = tuple(chance.uniform(0.03, 0.4, 3))
    points = occlusion_kernel.sample_points(tuple(middle), size, float(chance.uniform(-3, 3)), (tuple(middle),))
    others[0] = middle
    begin = chance.integers(0, 58, count)
    wanted = np.column_stack([chance.choice([0.0, 1.0], count, p=[0.2, 0.8]), begin, begin + 2]).astype(float)
    pose = Pose(x=0.1, y=-0.2, yaw=yaw, pitch=pitch)
    view, bodies = (
        view_frustum.view_vector(pose, avatar.HUMAN),
        (scene.half, scene.pos, scene.mat, scene.radius, scene.ids),
    )
    whole = slowly(
        view, 0, [point[None] for point in points], [99.0] * len(points), [tuple(wanted[0, 1:])] * len(points), *bodies
    )
    to = middle - view[:3]
    near = [
        k
        for k in range(1, count)
        if wanted[k, 0] > 0.0
        and math.acos(
            min(1.0, float((others[k] - view[:3]) @ to) / np.linalg.norm(others[k] - view[:3]) / np.linalg.norm(to))
        )
        <= occlusion_kernel.BESIDE_RAD
    ]
    crowd = slowly(
        view, 0, [others[k][None] for k in near], [99.0] * len(near), [tuple(wanted[k, 1:]) for k in near], *bodies
    )
    occluders = Occluders(scene)
    occluders.follow(1)
    around = occluders.arrays
    eye = pose.x, pose.y, avatar.HUMAN.eye, yaw, pitch, *view_frustum.half_fov_tangents(avatar.HUMAN)
    found = occlusion_kernel.measure(*eye, points, 0, others, wanted, *around)
    assert found == (len(whole) / len(points), len(crowd))
    assert view_frustum.view_axes(*eye) == pytest.approx(tuple(view))


@pytest.fixture(scope="module")
def built():
    return World(tiny.house(), robots=("scout",))


@pytest.fixture
def world(built):
    crowd = [on(TABLE, "mug", v=0.2), on(TABLE, "remote_control", v=-0.2)]
    objects = (on(TABLE, "apple"), *crowd, on(FRIDGE, "tomato", surface=1), on(COFFEE, "lettuce"))
    robot = (Pose(x=8.5, y=1.4, yaw=math.pi),)
    built.reset(task(*objects, human=Pose(x=4.0, y=2.6, yaw=math.pi, pitch=-0.4), robots=robot))
    return built


def test_in_the_open_all_of_a_thing_is_in_view_and_behind_a_wall_nothing(world):
    eyes = world.senses(HUMAN)
    assert eyes.sighting("apple") == Sighting(share=1.0, beside=3)  # with the house's vase
    assert eyes.sighting("lettuce") == Sighting()
    assert eyes.sighting("tomato") == Sighting()
    assert eyes.sighting(TABLE) == eyes.sighting("no such thing") == Sighting()
    world.teleport(HUMAN, Pose(x=4.0, y=2.6))
    assert world.senses(HUMAN).sighting("apple") == Sighting()  # behind the back
    wait(world, 1)
    with pytest.raises(StaleObservation):
        eyes.sighting("apple")


def test_what_peeps_out_of_a_fridge_is_seen_in_part(world):
    world.teleport(HUMAN, Pose(x=0.75, y=2.6, yaw=math.pi / 2))
    do(world, HUMAN, Open(thing=FRIDGE))
    shares = []
    for x in np.arange(0.35, 1.5, 0.05):
        yaw = math.atan2(3.55 - 2.2, 0.6 - x)
        world.teleport(HUMAN, Pose(x=float(x), y=2.2, yaw=yaw, pitch=-0.2))
        senses = world.senses(HUMAN)
        found = senses.sighting("tomato").share
        assert (found > 0.0) == any(seen.id == "tomato" for seen in senses.detections())
        shares.append(found)
    assert {0.0, 1.0} <= set(shares)
    assert any(0.0 < found < 1.0 for found in shares)


# ---------------------------------------------------------------------------------------------------- eyes on their own


def apple(position=(2.0, 0.0, 1.6), **more):
    distance = math.dist(position, (0.0, 0.0, BODY.eye))
    return Detection(
        id=more.pop("id", "apple"),
        kind="apple",
        family="object",
        position=position,
        size=(0.08, 0.08, 0.08),
        yaw=0.0,
        distance=distance,
        **more,
    )


def fridge(state=""):
    return Detection(
        id="fridge|1", kind="fridge", family="furniture", position=(2.0, 0.0, 0.9), size=(0.7, 0.7, 1.8), yaw=0.0,
        distance=2.1, state=state,
    )  # fmt: skip


FIND = (Job(target="apple", relation="find"),)


class Looker:
    """A person's eyes alone, shown what a test likes."""

    def __init__(self, root=0, traits=TRAITS, jobs=FIND, share=1.0, beside=0):
        self.sight = Sighting(share=share, beside=beside)
        briefing = Briefing(
            seat=HUMAN, instruction="", target=jobs[0].target, destination="", relation="find", body=BODY, tick_s=0.1,
            time_limit=90.0, jobs=jobs,
        )  # fmt: skip
        self.me = HumanContext(traits, root, briefing)
        self.objects, self.memory = ObjectMemory(job.target for job in jobs), SpatialMemory(tau=traits.tau_mem / 0.1)
        self.told = []
        self.me.listener = self.told.append
        self.eyes = Eyes(self.me, self.objects, self.memory)
        self.tick = 0

    def see(self, *detections, ticks=3, yaw=0.0):
        senses = SimpleNamespace(detections=lambda: detections, sighting=lambda id: self.sight)
        self.tick += ticks
        self.me.now = Observation(tick=self.tick, pose=Pose(x=0.0, y=0.0, yaw=yaw), idle=True, senses=senses)
        self.eyes.look(self.me.now)

    @property
    def knows(self):
        return self.objects.known["apple"].seen is not None


def test_the_time_to_notice_is_exponential():
    """The law that the journal's readers fit: after a time t of equal glimpses exp(-rate t) have noticed nothing."""
    steady = detection_rate(TRAITS, 0.08 / 2.0, 0.0, 0.8, 2)
    lookers = [Looker(seeds.derive(0, k), share=0.8, beside=2) for k in range(400)]
    for _ in range(5):
        for one in lookers:
            one.see(apple())
    seconds = 0.1 + 4 * 0.3
    missed = sum(not one.knows for one in lookers) / len(lookers)
    assert missed == pytest.approx(math.exp(-steady * seconds), abs=3.0 * math.sqrt(0.25 / len(lookers)))
    assert 0.2 < missed < 0.8


@settings(max_examples=cases(10))
@given(st.integers(0, 10**9), st.integers(1, 200))
def test_what_is_hidden_is_never_noticed(root, glimpses):
    looker = Looker(root, share=0.0)
    for _ in range(glimpses):
        looker.see(apple())
    assert not looker.knows


def test_nobody_notices_what_a_closed_fridge_hides():
    flat = Flat("Fridge|1")
    flat._done = lambda motion, done=flat._done: flat.outcome if isinstance(motion, Open) else done(motion)
    model = Model(Participant(seed=1, number=0, traits=msgspec.structs.replace(TRAITS, lam0=3.0)))
    model.begin(flat.briefing())
    play(model, flat, ticks=600)
    assert model._objects.known["apple"].seen is None
    model.rate(False, flat.tick)
    assert not [event for event in model.journal if event.kind == "exposure"]


def test_searching_a_place_counts_by_what_would_have_been_seen_there():
    def exposed(jobs, **seen):
        looker = Looker(jobs=jobs)
        for _ in range(40):
            looker.see(fridge(), **seen)
        return looker.memory.exposure(looker.memory.places["fridge|1"], looker.tick)

    small, large = (Job(target=name, relation="find") for name in ("tomato", "book"))
    assert exposed((small,)) < exposed((small, large)) < exposed((large,))
    assert exposed((small,), yaw=0.6) < exposed((small,), yaw=0.0)
    shut = Looker()
    for _ in range(40):
        shut.see(fridge("closed"))
    assert shut.memory.places["fridge|1"].exposure == 0.0


def test_a_search_fades_from_memory():
    memory = SpatialMemory(tau=200.0)
    place = memory.keep_place(fridge())
    memory.expose(place, 2.0, 100)
    assert memory.exposure(place, 300) == pytest.approx(2.0 / math.e)


# ---------------------------------------------------------------------------------------------------------- forgetting

JOBS = (
    Job(target="book", relation="on", destinations=("fridge",)),
    Job(target="apple", relation="on", destinations=("fridge",)),
)
KEEN = msgspec.structs.replace(TRAITS, lam0=1e6, lam_furniture=1e6, tau_seen=30.0)


def after(seconds, count=400, jobs=JOBS, mind=lambda looker: None):
    """People who saw the apple and a fridge, that long ago."""
    lookers = [Looker(seeds.derive(3, k), KEEN, jobs) for k in range(count)]
    for one in lookers:
        one.see(apple(), fridge())
        assert one.knows
        mind(one)
        for _ in range(round(seconds / 1.5)):
            one.see(ticks=15)
    return lookers


@pytest.mark.parametrize("seconds", [9.0, 36.0])
def test_what_is_out_of_view_is_still_known_with_the_chance_of_the_law(seconds):
    lookers = after(seconds)
    kept = math.exp(-seconds / KEEN.tau_seen)
    noise = 3.0 * math.sqrt(kept * (1 - kept) / len(lookers))
    assert sum(one.knows for one in lookers) / len(lookers) == pytest.approx(kept, abs=noise)
    places = [one.memory.places["fridge|1"] for one in lookers]
    assert sum(place.recalled for place in places) / len(places) == pytest.approx(kept, abs=noise)


def test_what_stays_in_view_is_not_forgotten_and_what_comes_back_must_be_noticed_anew():
    lookers = [Looker(seeds.derive(4, k), KEEN, JOBS) for k in range(60)]
    for one in lookers:
        for _ in range(100):
            one.see(apple(), fridge(), ticks=9)
        assert one.knows
        assert one.memory.places["fridge|1"].recalled
        while one.knows or one.memory.places["fridge|1"].recalled:
            one.see(ticks=9)
        news = one.objects.changes
        one.see(apple(), fridge())
        assert one.knows
        assert one.memory.places["fridge|1"].recalled
        assert one.objects.changes > news
        kinds = [(event.kind, event.object) for event in one.told]
        assert [name for kind, name in kinds if kind == "noticed"].count("apple") == 2
        assert {("forgot", "apple"), ("forgot", "fridge|1")} <= set(kinds)


def test_what_people_are_about_hold_or_head_for_is_not_forgotten():
    def about(looker):
        looker.eyes.current = looker.objects.known["apple"]
        looker.memory.heading = "fridge|1"

    assert all(one.knows and one.memory.places["fridge|1"].recalled for one in after(300.0, 40, mind=about))
    holder = Looker(5, KEEN, JOBS)
    holder.see(apple(held_by=HUMAN))
    for _ in range(400):
        holder.tick += 9
        nothing = SimpleNamespace(detections=lambda: ())
        now = Observation(tick=holder.tick, pose=Pose(x=0.0, y=0.0), idle=True, senses=nothing, holding="apple")
        holder.me.now = now
        holder.eyes.look(now)
    assert holder.knows


def test_an_object_is_taken_by_whoever_else_holds_it():
    for owner, others in (("human", ("human2", "robot")), ("human2", ("human", "robot"))):
        known = ObjectMemory(["apple"], owner).known["apple"]
        assert not known.taken
        for holder, taken in (("", False), (owner, False), *((other, True) for other in others)):
            known.seen = apple(held_by=holder)
            assert (known.taken, known.lies is None) == (taken, taken)


def test_furniture_that_nothing_is_brought_to_stays_where_it_is():
    jobs = tuple(msgspec.structs.replace(job, destinations=("sofa",)) for job in JOBS)
    assert all(one.memory.places["fridge|1"].recalled for one in after(300.0, 40, jobs=jobs))


def test_a_destination_that_was_forgotten_is_found_again():
    traits, forgot = msgspec.structs.replace(TRAITS, tau_seen=1.5), 0
    for person in range(4):
        flat, told = Flat("Bed|1"), []
        model = Model(Participant(seed=2, number=person, traits=traits))
        model.begin(flat.briefing(relation="in", destination="fridge"))
        model._human.listener = told.append
        play(model, flat, ticks=3000, until=lambda flat=flat: flat.support == "Fridge|1" and not flat.held)
        assert flat.support == "Fridge|1"
        forgot += "Fridge|1" in [event.object for event in told if event.kind == "forgot"]
    assert forgot >= 2


# ---------------------------------------------------------------------------------------------------------- the journal


def exposures(looker):
    return [entry for entry in looker.me.journal if entry.kind == "exposure"]


@settings(max_examples=cases(30))
@given(st.integers(0, 10**9), st.lists(st.tuples(st.floats(0.6, 6.0), st.floats(-0.8, 0.8)), min_size=1, max_size=60))
def test_the_journal_holds_all_that_led_to_noticing(root, glances):
    """The rates of what is written down add up to those that were gathered, nearly: alike glimpses are averaged."""
    looker, total, last = Looker(root, share=0.7, beside=1), 0.0, 0.0
    for far, yaw in glances:
        looker.see(apple((far, 0.0, 1.6)), yaw=yaw)
        last = detection_rate(TRAITS, 0.08 / far, abs(yaw), 0.7, 1) * (0.1 if looker.tick == 3 else 0.3)
        total += last
        if looker.knows:
            break
    looker.eyes.end()
    (entry,) = exposures(looker)
    assert entry.noticed == looker.knows
    assert entry.seconds == pytest.approx(sum(row[0] for row in entry.gathered))
    summed = [detection_rate(TRAITS, row[1], row[2], row[3], row[4]) * row[0] for row in entry.gathered]
    assert sum(summed) == pytest.approx(total, rel=0.02, abs=1e-3)
    assert summed[-1] == pytest.approx(last, rel=0.01, abs=1e-4)
    assert not any(row[5] for row in entry.gathered)


def test_an_object_that_is_looked_for_just_there_is_noticed_sooner_and_the_journal_says_so():
    looker = Looker(1)
    looker.eyes.attention = (2.0, 0.0, 1.0)
    looker.see(apple())
    looker.eyes.end()
    (entry,) = exposures(looker)
    assert entry.gathered[-1][5] == 1
    counts = [0, 0]
    for attended in (0, 1):
        for k in range(200):
            one = Looker(seeds.derive(7, k))
            one.eyes.attention = (2.0, 0.0, 1.0) if attended else None
            one.see(apple())
            one.see(apple())
            counts[attended] += one.knows
    assert counts[0] < counts[1]


def test_glimpses_that_are_alike_share_a_row_and_no_more_is_written_at_the_end():
    looker = Looker(0)
    looker.me.now = Observation(tick=5, pose=Pose(x=0.0, y=0.0), idle=True, senses=None)
    book = ExposureLog(looker.me)
    for k in range(500):
        book.add("apple", Glimpse(0.3, 0.04 + 1e-5 * k, 0.2 + 1e-4 * k, 1.0, 0, False))
    book.end()
    book.end()
    (entry,) = exposures(looker)
    assert len(entry.gathered) < 10
    assert entry.seconds == pytest.approx(150.0)
    assert not entry.noticed


@pytest.mark.parametrize("support", FURNITURE)
def test_the_same_person_writes_the_same_journal(support):
    def written():
        flat = Flat(support)
        model = Model(Participant(seed=1, number=2))
        model.begin(flat.briefing())
        play(model, flat, ticks=300)
        model.rate(False, flat.tick)
        return msgspec.json.encode(list(model.journal))

    assert written() == written()
