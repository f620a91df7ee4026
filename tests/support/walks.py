"""Trials in which somebody has to follow an instruction."""

from __future__ import annotations

from worlds import world_of

from hthor import plugins, tasks
from hthor.episode import play
from hthor.humans.models.proxy import Model
from hthor.humans.population.participant import Participant
from hthor.types import AgentRef, HumanSeat, RobotSeat, TrialSpec

PRIVILEGES = {"frontier": ("ideal_detector",), "oracle": ("house_map", "ideal_detector", "object_poses")}


def walk(task_id, agent="", participant=0):
    """One trial of a task of the suite `vln`, with a scout if an agent is named: its task and its log."""
    task = next(task for task in tasks.load_suite("vln").tasks if task.id == task_id)
    robots, minds = (), {}
    if agent:
        ref = AgentRef(name=agent, source="", sha256="", privileges=PRIVILEGES[agent])
        robots = (RobotSeat(seat="robot", robot="scout", agent=ref),)
        minds = {"robot": plugins.load("agent", agent)()}
    trial = TrialSpec(
        task=task,
        robots=robots,
        humans=(HumanSeat(seat="human", model="proxy", sha256="", participant=participant),),
        session=participant,
        index=0,
        seed=0,
        suite_sha256="",
        rules_sha256="",
        code_sha256="",
    )
    log = play(
        trial,
        world_of(task, ("scout",) if agent else ()),
        {"human": Model(Participant(seed=0, number=participant))},
        minds,
    )
    assert not log.faults
    return task, log
