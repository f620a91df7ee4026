"""A briefing, observations and small agent files for tests of submitted agents, and the processes of a guest."""

from __future__ import annotations

import contextlib
import shutil
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hthor.guest import Guest, GuestConfig
from hthor.types import BodySpec, Briefing, Camera, Detection, Observation, Pose, Scan

BRIEFING = Briefing(
    seat="robot",
    instruction="Find an apple.",
    target="apple",
    destination="",
    relation="find",
    body=BodySpec(
        name="disc",
        title="disc",
        radius=0.2,
        height=1.0,
        eye=0.9,
        fov=(1.2, 1.2),
        speed=1.0,
        turn_rate=1.8,
        sight_range=1.5,
        scan_range=5.0,
        scan_beams=61,
        pitch_limit=0.5,
        capabilities=frozenset({"navigate"}),
    ),
    tick_s=0.1,
    time_limit=90.0,
)
HEAD = "import math, os, sys, time\nfrom hthor.types import *\n"


class Sensors:
    """Counts what is read."""

    def __init__(self) -> None:
        self.read: list[str] = []

    def scan(self) -> Scan:
        self.read.append("scan")
        return Scan(origin=Pose(x=1.0, y=2.0), bearings=np.linspace(-1, 1, 61), ranges=np.full(61, 2.5), limit=5.0)

    def detections(self) -> tuple[Detection, ...]:
        self.read.append("detections")
        return (
            Detection(
                id="apple", kind="apple", family="object", position=(1, 2, 0.8), size=(0.1, 0.1, 0.1), yaw=0, distance=1
            ),
        )

    def rgb(self) -> Any:
        self.read.append("rgb")
        return np.arange(300 * 400 * 3, dtype=np.uint32).astype(np.uint8).reshape(300, 400, 3)

    def depth(self) -> Any:
        raise ValueError("no picture today")

    def camera(self) -> Camera:
        self.read.append("camera")
        return Camera(size=(400, 300), matrix=np.diag((200.0, 200.0, 1.0)), pose=np.eye(4), near=0.02, far=80.0)


def look(tick: int = 0, senses: object = None, **more: Any) -> Observation:
    return Observation(tick=tick, pose=Pose(x=0.1, y=0.2, yaw=0.3), idle=True, senses=senses or Sensors(), **more)


def agent(act: str, begin: str = "pass") -> str:
    lines = "\n".join(f"        {line}" for line in act.splitlines())
    return f"class Agent:\n    def begin(self, briefing):\n        {begin}\n    def act(self, observation):\n{lines}\n"


def living(group: int) -> list[str]:
    """Processes of a group that still run, or will after a moment; the dead whom nobody has collected do not count."""
    for _ in range(100):
        found = []
        for stat in Path("/proc").glob("[0-9]*/stat"):
            with contextlib.suppress(OSError):
                state, _, pgrp = stat.read_text().rpartition(")")[2].split()[:3]
                found += [stat.parent.name] if int(pgrp) == group and state not in "ZX" else []
        if not found:
            break
        time.sleep(0.05)
    return found


def expect_gone(pids: list[int]) -> None:
    """All these processes have ended, or end after a moment."""
    end = time.monotonic() + 900.0
    while any(map(_alive, pids)) and time.monotonic() < end:
        time.sleep(0.005)
    assert not any(map(_alive, pids))


def _alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False


needs_bwrap = pytest.mark.skipif(not shutil.which("bwrap"), reason="needs bubblewrap")
PROCESS_CHAINS = [("L1", 3), ("L2", 3), pytest.param("L3", 4, marks=needs_bwrap)]
"""How many processes a guest is at each level: guard or bubblewrap's two, supervisor, and the trial's own."""


def process_chain(pid: int) -> list[int]:
    """A process and its descendants, of which each has one child at most."""
    found = [pid]
    while children := Path(f"/proc/{found[-1]}/task/{found[-1]}/children").read_text().split():
        found.append(int(children[0]))
    return found


def start_trial(path: Path, level: str) -> Guest:
    path.write_text(HEAD + agent("time.sleep(0.05); return Action()"))
    guest = Guest(path, config=GuestConfig(isolation=level))
    guest.begin(BRIEFING)
    guest.act(look())
    return guest
