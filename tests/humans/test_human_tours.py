"""People who look around before a task, and what they remember of it."""

from __future__ import annotations

import math

import msgspec
from hypothesis import given
from hypothesis import strategies as st
from worlds import world_of

from hthor import tasks
from hthor.episode import play, task_began
from hthor.eval.records import trial_record
from hthor.humans.behaviours.tour import BORED_S, HouseTour
from hthor.humans.memory.object_memory import KnownObject, ObjectMemory
from hthor.humans.memory.tour_memory import remembered_briefing, still_believed
from hthor.humans.models.greedy import Model as Greedy
from hthor.humans.models.proxy import Model
from hthor.humans.perception.perception import Eyes
from hthor.humans.population.parameters import Parameters
from hthor.humans.population.participant import Participant
from hthor.types import HUMAN, Briefing, Detection, HumanSeat, Job, Observation, PhaseBriefing, TrialSpec
from hthor.types.events import PhaseBegan, Picked, SaidReady
from hthor.world.model.bodies import avatar

NAMES = ("apple", "book", "mug")
TASK = next(task for task in tasks.load_suite("rearrange").tasks if task.id == "rearrange/juniper/02")


def detection(id: str, support: str = "table", held_by: str = "") -> Detection:
    return Detection(
        id=id,
        kind=id,
        family="object",
        position=(1.0, 2.0, 0.8),
        size=(0.1, 0.1, 0.1),
        yaw=0.0,
        distance=1.0,
        support=support,
        held_by=held_by,
    )


def briefing(*jobs: Job) -> Briefing:
    return Briefing(
        seat=HUMAN,
        instruction="",
        target=jobs[0].target,
        destination="",
        relation=jobs[0].relation,
        body=avatar.HUMAN,
        tick_s=0.1,
        time_limit=90.0,
        jobs=jobs,
        phases=(PhaseBriefing(name="tour", instruction="", time_limit=60.0),),
    )


@given(st.sets(st.sampled_from(NAMES)))
def test_people_restore_what_they_remember_and_nothing_else(noticed: set[str]) -> None:
    memory = ObjectMemory(NAMES)
    for name in noticed:
        memory.see(memory.known[name], detection(name), 5, (0.0, 0.0))
    after = remembered_briefing(briefing(*(Job(target=name, relation="back") for name in NAMES)), memory)
    assert after.phases == ()
    if not noticed:
        assert after.jobs == (Job(target="apple", relation="back"),), "nothing can be done about it"
        return
    assert {job.target for job in after.jobs} == noticed
    assert {(job.destinations, job.place) for job in after.jobs} == {(("table",), (1.0, 2.0, 0.8))}
    assert all(one.seen is None for one in still_believed(after.jobs, memory, HUMAN).known.values()), "look again"


def test_what_was_told_is_not_a_matter_of_memory() -> None:
    memory = ObjectMemory(NAMES)
    memory.see(memory.known["apple"], detection("apple"), 5, (0.0, 0.0))
    told = Job(target="apple", relation="on", destinations=("dining_table",))
    after = remembered_briefing(briefing(told), memory)
    assert after.jobs == (told,)
    believed = still_believed(after.jobs, memory, HUMAN).known["apple"]
    assert believed.seen is not None, "people believe that it is still where they saw it"


def test_what_somebody_holds_has_no_place_to_remember() -> None:
    memory = ObjectMemory(NAMES)
    memory.see(memory.known["mug"], detection("mug", "", "human2"), 5, (0.0, 0.0))
    after = remembered_briefing(briefing(Job(target="mug", relation="back")), memory)
    assert after.jobs == (Job(target="mug", relation="back"),)


def trial(task: object, session: int = 0) -> TrialSpec:
    return TrialSpec(
        task=task,  # type: ignore[arg-type]
        robots=(),
        humans=(HumanSeat(seat=HUMAN, model="proxy", sha256="", participant=session),),
        session=session,
        index=0,
        seed=0,
        suite_sha256="",
        rules_sha256="",
        code_sha256="",
    )


def played(model: type, number: int = 0) -> tuple[object, object]:
    person = model(Participant(seed=0, number=number, traits=Parameters()))
    task = msgspec.structs.replace(TASK, time_limit=20.0)
    return person, play(trial(task, number), world_of(TASK), {HUMAN: person}, {})


def test_people_walk_the_tour_and_say_when_they_are_ready() -> None:
    person, log = played(Model)
    ready = [event.tick for event in log.events if isinstance(event, SaidReady)]  # type: ignore[attr-defined]
    began = task_began(log)  # type: ignore[arg-type]
    assert len(ready) == 1
    assert began is not None
    assert ready[0] < began <= ready[0] + 2 < 10 * TASK.phases[0].time_limit
    truth = {job.target: job.place for job in TASK.goal.jobs}
    known = person._human.task.jobs  # type: ignore[attr-defined]
    assert 0 < len(known) <= len(truth)
    for job in known:
        assert math.dist(job.place, truth[job.target]) < 0.05, "it was there on the tour"
    spots = [one.spot for one in person._subgoals.all.values() if one.spot is not None]  # type: ignore[attr-defined]
    assert spots
    assert all(spot not in truth.values() for spot in spots), "but is remembered with an error"


class Absent(Eyes):
    """Eyes that notice nothing."""

    def look(self, now: Observation) -> None:
        self.at = now.tick


class Oblivious(Model):
    eyes = Absent


def test_people_who_remember_nothing_rest() -> None:
    person, log = played(Oblivious)
    assert person.about == "rest"  # type: ignore[attr-defined]
    began = task_began(log)  # type: ignore[arg-type]
    assert began is not None
    assert not [event for event in log.events if event.tick > began and isinstance(event, Picked)]  # type: ignore[attr-defined]


def test_the_same_person_has_the_same_tour() -> None:
    logs = [played(Model, 3)[1] for _ in range(2)]
    one, two = (trial_record.encode(trial_record.make_record(trial(TASK, 3), log)) for log in logs)  # type: ignore[arg-type]
    assert one == two


def test_other_human_models_tour_as_well() -> None:
    _, log = played(Greedy)
    assert [event.name for event in log.events if isinstance(event, PhaseBegan)] == ["tour", ""]  # type: ignore[attr-defined]


class Still:
    """An exploration that finds nothing new."""

    def __init__(self) -> None:
        self.memory = type("Memory", (), {"places": {}})()
        self.walker = None
        self.human = type("Human", (), {"now": type("Now", (), {"tick": 0})(), "tick_s": 0.1})()


def test_a_tour_ends_when_all_was_noticed_or_nothing_new_comes() -> None:
    still, objects = Still(), ObjectMemory(NAMES)
    tour = HouseTour(still, objects)  # type: ignore[arg-type]
    assert not tour._is_over()
    still.human.now.tick = round(BORED_S / 0.1)
    assert not tour._is_over()
    objects.known["mug"] = KnownObject(id="mug", seen=detection("mug"))
    still.human.now.tick += 1
    assert not tour._is_over(), "something new"
    still.human.now.tick += round(BORED_S / 0.1) + 1
    assert tour._is_over(), "bored"
    fresh = HouseTour(still, ObjectMemory(NAMES))  # type: ignore[arg-type]
    assert not fresh._is_over()
    for name in NAMES:
        fresh.objects.known[name] = KnownObject(id=name, lost=1)
    assert fresh._is_over(), "all were noticed, though forgotten since"
