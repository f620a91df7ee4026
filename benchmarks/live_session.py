"""What sessions with people at pages take: ``python -m benchmarks.live_session [--people 2] [--sessions 1]``.

Starts `hthor live` with a robot, as many times as there are sessions, and clients that behave as pages do: each sends
steering 60 times a second, walks in a circle, and rates. Measured on this machine, over the loopback: how long it takes
from an input to the first frame that acknowledges it, how many bytes each client receives and sends, how much of a core
the servers take with their robots, which steps of the trials that ended were late, and how memory grows.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import Future
from contextlib import ExitStack, suppress
from pathlib import Path

import numpy as np
import uvloop
from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed

from benchmarks import table
from hthor.eval.records.run_folder import RunFolder
from hthor.live import wire
from hthor.types import SUBTICKS, Drive
from hthor.types.events import Note

RATE_HZ, TURN_S = 60, 4.0
_PERSON_S = 600.0
"""[s] Each person's ten trials take longer than this."""
_PATIENCE_S, _SETTLE_S = 900.0, 2.0
_LOOKS = 20
"""How often memory is looked at."""
_URL = re.compile(r"open (http://\S+)/#(\S+)")
_CLOCK = os.sysconf("SC_CLK_TCK")


class Client:
    """A page without a picture."""

    def __init__(self, socket: ClientConnection) -> None:
        self._socket = socket
        self._sent_at: dict[int, float] = {}
        self._last = 0
        self.latencies_s: list[float] = []
        self.received = self.sent = 0
        self.began = threading.Event()

    def restart(self) -> None:
        """Forget what was measured so far."""
        self.latencies_s, self.received, self.sent = [], 0, 0

    async def tell(self, data: str | bytes) -> None:
        """Send a message."""
        self.sent += len(data)
        await self._socket.send(data)

    async def steer(self, number: int, drive: Drive) -> None:
        """Send steering, and every second how the page is."""
        self._sent_at[number] = time.perf_counter()
        await self.tell(wire.encode_steering(wire.Steering(number, drive)))
        if number % RATE_HZ == 0:
            await self.tell(json.dumps({"type": "ping", "sent": time.perf_counter(), "frames": 60.0}))

    async def read(self) -> None:
        """Answer what comes, until the server is gone."""
        with suppress(ConnectionClosed):
            async for data in self._socket:
                self.received += len(data)
                if isinstance(data, str):
                    await self._answer(json.loads(data))
                elif data[0] == 2:
                    self._acknowledge(wire.decode_frame(data)[0].steering)

    async def _answer(self, message: dict[str, object]) -> None:
        if message["type"] == "trial":
            await self.tell(json.dumps({"type": "begin", "trial": message["trial"]}))
        elif message["type"] == "began":
            self.began.set()
        elif message["type"] == "ended" and message["rate"]:
            await self.tell(json.dumps({"type": "rate", "trial": message["trial"], "value": 5}))

    def _acknowledge(self, number: int) -> None:
        """The first frame after an input: how long that took, for the newest input that it acknowledges."""
        if number > self._last and number in self._sent_at:
            self.latencies_s.append(time.perf_counter() - self._sent_at.pop(number))
            self._last = number


class Clients:
    """All pages, in one thread, so that they take little of the machine that the servers are measured on."""

    def __init__(self) -> None:
        self._loop = uvloop.new_event_loop()
        self._joined: list[Client] = []
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        self._work: list[Future[None]] = [asyncio.run_coroutine_threadsafe(self._steer(), self._loop)]

    def join(self, address: str, token: str) -> Client:
        """Open the page of a seat."""
        client = asyncio.run_coroutine_threadsafe(_join(address, token), self._loop).result()
        self._work.append(asyncio.run_coroutine_threadsafe(client.read(), self._loop))
        self._joined.append(client)
        return client

    def close(self) -> None:
        """Leave."""
        for one in self._work:
            one.cancel()
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()

    async def _steer(self) -> None:
        number, begin = 0, time.perf_counter()
        while True:
            number += 1
            angle = 2.0 * np.pi * (time.perf_counter() - begin) / TURN_S
            drive = Drive(forward=0.7, yaw=float(angle), pitch=0.1)
            for client in self._joined:
                with suppress(ConnectionClosed):
                    await client.steer(number, drive)
            await asyncio.sleep(max(0.0, begin + number / RATE_HZ - time.perf_counter()))


async def _join(address: str, token: str) -> Client:
    socket = await connect(
        address.replace("http", "ws", 1) + "/live",
        subprotocols=[wire.VERSION],  # type: ignore[list-item]
        origin=address,  # type: ignore[arg-type]
        compression=None,
    )
    client = Client(socket)
    await client.tell(json.dumps({"type": "join", "token": token}))
    return client


def rows(sessions: int, people: int, seconds: float, agent: str) -> Iterator[table.Row]:
    """Measure so many sessions at once."""
    with tempfile.TemporaryDirectory() as name, ExitStack() as stack:
        folders = [Path(name, f"run{number}") for number in range(sessions)]
        servers = [_start(folder, people, agent, seconds) for folder in folders]
        for server in servers:
            stack.callback(_end, server)
        pages = Clients()
        clients = [client for server in servers for client in _clients(server, people, pages)]
        for client in clients:
            if not client.began.wait(_PATIENCE_S):
                raise RuntimeError(f"the trial did not begin within {_PATIENCE_S:.0f} s")
        yield from _measure(servers, clients, seconds, f"{sessions} x {people} at pages")
        pages.close()
        yield from _late_steps(folders, f"{sessions} x {people} at pages")


def _start(folder: Path, people: int, agent: str, seconds: float) -> subprocess.Popen[str]:
    """Start the command of a session that takes longer than ``seconds``."""
    participants = people * math.ceil((seconds + _PATIENCE_S) / _PERSON_S)
    words = (
        f"-m hthor live --port 0 --no-practice --agent {agent} --out {folder} --humans {','.join(['live'] * people)}"
        f" --participants {participants}"
    )
    kind = ["--kind", "collect"] if people > 1 else []
    return subprocess.Popen([sys.executable, *words.split(), *kind], stderr=subprocess.PIPE, text=True)


def _end(server: subprocess.Popen[str]) -> None:
    server.kill()
    server.wait()


def _clients(server: subprocess.Popen[str], people: int, pages: Clients) -> Iterator[Client]:
    """Open the pages of a session."""
    assert server.stderr is not None
    for line in server.stderr:
        if found := _URL.search(line):
            yield pages.join(*found.groups())
            people -= 1
        if not people:
            break
    threading.Thread(target=server.stderr.read, daemon=True).start()


def _measure(
    servers: Sequence[subprocess.Popen[str]], clients: Sequence[Client], seconds: float, part: str
) -> Iterator[table.Row]:
    time.sleep(_SETTLE_S)
    for client in clients:
        client.restart()
    begin, before, own_before = time.perf_counter(), [_cpu_s(server.pid) for server in servers], time.process_time()
    used = [_memory_mb(servers)]
    for _ in range(_LOOKS):
        time.sleep(seconds / _LOOKS)
        used.append(_memory_mb(servers))
    spent, after = time.perf_counter() - begin, [_cpu_s(server.pid) for server in servers]
    clients_s = time.process_time() - own_before
    latencies = 1e3 * np.concatenate([client.latencies_s for client in clients])
    what = "input to acknowledged pose"
    yield table.Row(part=part, what=f"{what}, median", value=float(np.median(latencies)), unit="ms")
    yield table.Row(part=part, what=f"{what}, 95 %", value=float(np.percentile(latencies, 95)), unit="ms", bar=30.0)
    for what, numbers in (
        ("received by a client", [client.received for client in clients]),
        ("sent by a client", [client.sent for client in clients]),
    ):
        yield table.Row(part=part, what=what, value=max(numbers) / spent / 1e3, unit="kB/s", bar=10.0)
    own, robots = 100.0 * (np.array(after) - before).sum(axis=0) / spent
    yield table.Row(part=part, what="servers", value=own, unit="% of a core", bar=25.0 * len(servers))
    yield table.Row(part=part, what="robots' processes", value=robots, unit="% of a core")
    yield table.Row(part=part, what="clients", value=100.0 * clients_s / spent, unit="% of a core")
    yield table.Row(part=part, what="memory of a server", value=used[-1] / len(servers), unit="MB")
    half = used[len(used) // 2]
    yield table.Row(part=part, what="its growth in the second half", value=(used[-1] - half) / len(servers), unit="MB")


def _late_steps(folders: Sequence[Path], part: str) -> Iterator[table.Row]:
    """How many steps of the trials that have ended were late by more than a step."""
    late = steps = 0.0
    for folder in folders:
        for record in RunFolder(folder).attempts():
            steps += record.log.ticks * SUBTICKS
            notes = [one for one in record.log.journal if isinstance(one, Note) and one.topic == "real time"]
            late += float(notes[0].values["late"])
    if steps:
        yield table.Row(
            part=part, what="late steps of trials that ended", value=100.0 * late / steps, unit="%", bar=1.0
        )


def _memory_mb(servers: Sequence[subprocess.Popen[str]]) -> float:
    """Memory [MB] that the servers have for themselves."""
    lines = (line for one in servers for line in Path(f"/proc/{one.pid}/smaps_rollup").read_text().splitlines())
    return sum(float(line.split()[1]) for line in lines if line.startswith("Private_")) / 1e3


def _cpu_s(pid: int) -> tuple[float, float]:
    """CPU time [s] of a process, and of all that it has started."""
    own, others = 0.0, 0.0
    children: dict[int, list[int]] = {}
    times: dict[int, float] = {}
    for entry in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = entry.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        number = int(entry.parent.name)
        children.setdefault(int(fields[1]), []).append(number)
        times[number] = (int(fields[11]) + int(fields[12])) / _CLOCK
    waiting, own = list(children.get(pid, ())), times.get(pid, 0.0)
    while waiting:
        child = waiting.pop()
        others += times.get(child, 0.0)
        waiting += children.get(child, ())
    return own, others


def main() -> None:
    """Measure and print."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.live_session", description=__doc__.splitlines()[0])
    options.add_argument("--sessions", type=int, default=1, help="how many sessions go on at once (%(default)s)")
    options.add_argument("--people", type=int, default=2, help="how many people are at pages (%(default)s)")
    options.add_argument("--seconds", type=float, default=60.0, help="how long to measure (%(default)s)")
    options.add_argument("--agent", default="frontier", help="the robot's agent (%(default)s)")
    options.add_argument("--json", action="store_true", help="JSON instead of a table")
    given = options.parse_args()
    table.put(list(rows(given.sessions, given.people, given.seconds, given.agent)), as_json=given.json)


if __name__ == "__main__":
    main()
