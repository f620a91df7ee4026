"""What a session with people at pages takes: `python -m benchmarks.live_session [--people 2] [--seconds 60]`.

Starts `hthor live` with a robot and clients that behave as pages do: each sends steering 60 times a second, walks in a
circle and now and then acts. Measured on this machine, over the loopback: how long it takes from an input to the first
frame that acknowledges it, how many bytes each client receives and sends, and how much of a core the server takes, with
its robots beside it.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import numpy as np
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from benchmarks import table
from hthor.live import wire
from hthor.types import Drive

RATE_HZ, TURN_S = 60, 4.0
_URL = re.compile(r"open (http://\S+)/#(\S+)")
_CLOCK = os.sysconf("SC_CLK_TCK")


class Client:
    """A page without a picture, in two threads."""

    def __init__(self, address: str, token: str) -> None:
        self._open = ExitStack()
        self._socket = self._open.enter_context(
            connect(
                address.replace("http", "ws", 1) + "/live",
                subprotocols=[wire.VERSION],  # type: ignore[list-item]
                origin=address,  # type: ignore[arg-type]
                compression=None,
            )
        )
        self._socket.send(json.dumps({"type": "join", "token": token}))
        self._sent_at: dict[int, float] = {}
        self._last = 0
        self.latencies_s: list[float] = []
        self.received = self.sent = 0
        self.began = threading.Event()
        self._ended = False
        self._threads = [threading.Thread(target=work, daemon=True) for work in (self._read, self._steer)]
        for thread in self._threads:
            thread.start()

    def restart(self) -> None:
        """Forget what was measured so far."""
        self.latencies_s, self.received, self.sent = [], 0, 0

    def close(self) -> None:
        """Leave."""
        self._ended = True
        self._open.close()
        for thread in self._threads:
            thread.join()

    def _tell(self, data: str | bytes) -> None:
        self.sent += len(data)
        self._socket.send(data)

    def _steer(self) -> None:
        number, begin = 0, time.perf_counter()
        try:
            while not self._ended:
                number += 1
                angle = 2.0 * np.pi * (time.perf_counter() - begin) / TURN_S
                drive = Drive(forward=0.7, yaw=float(angle), pitch=0.1)
                self._sent_at[number] = time.perf_counter()
                self._tell(wire.encode_steering(wire.Steering(number, drive)))
                if number % RATE_HZ == 0:
                    self._tell(json.dumps({"type": "ping", "sent": time.perf_counter(), "frames": 60.0}))
                time.sleep(max(0.0, begin + number / RATE_HZ - time.perf_counter()))
        except ConnectionClosed:
            return

    def _read(self) -> None:
        try:
            for data in self._socket:
                self.received += len(data)
                if isinstance(data, str):
                    self._answer(json.loads(data))
                elif data[0] == 2:
                    self._acknowledge(wire.decode_frame(data)[0].steering)
        except ConnectionClosed:
            return

    def _answer(self, message: dict[str, object]) -> None:
        if message["type"] == "trial":
            self._tell(json.dumps({"type": "begin", "trial": message["trial"]}))
        elif message["type"] == "began":
            self.began.set()

    def _acknowledge(self, number: int) -> None:
        """The first frame after an input: how long that took, for the newest input that it acknowledges."""
        if number > self._last and number in self._sent_at:
            self.latencies_s.append(time.perf_counter() - self._sent_at.pop(number))
            self._last = number


def rows(people: int, seconds: float, agent: str) -> Iterator[table.Row]:
    """Measure one session."""
    with tempfile.TemporaryDirectory() as folder:
        words = [
            sys.executable,
            "-m",
            "hthor",
            "live",
            "--port",
            "0",
            "--agent",
            agent,
            "--out",
            str(Path(folder) / "run"),
        ]
        words += [
            "--humans",
            ",".join(["live"] * people),
            "--no-practice",
            *(["--kind", "collect"] if people > 1 else []),
        ]
        server = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)
        try:
            yield from _measure(server, people, seconds)
        finally:
            server.kill()
            server.wait()


def _measure(server: subprocess.Popen[str], people: int, seconds: float) -> Iterator[table.Row]:
    assert server.stderr is not None
    clients: list[Client] = []
    for line in server.stderr:
        if found := _URL.search(line):
            clients.append(Client(*found.groups()))
        if len(clients) == people:
            break
    threading.Thread(target=server.stderr.read, daemon=True).start()
    for client in clients:
        if not client.began.wait(300.0):
            raise RuntimeError("the trial did not begin within 300 s")
    time.sleep(2.0)
    for client in clients:
        client.restart()
    begin, before = time.perf_counter(), _cpu_s(server.pid)
    time.sleep(seconds)
    spent, after = time.perf_counter() - begin, _cpu_s(server.pid)
    latencies = np.concatenate([client.latencies_s for client in clients])
    part = f"{people} at pages"
    yield table.Row(
        part=part, what="input to acknowledged pose, median", value=1e3 * float(np.median(latencies)), unit="ms"
    )
    p95 = 1e3 * float(np.percentile(latencies, 95))
    yield table.Row(part=part, what="input to acknowledged pose, 95 %", value=p95, unit="ms", bar=30.0)
    for what, most, numbers in (
        ("received by a client", 10.0, [client.received for client in clients]),
        ("sent by a client", 10.0, [client.sent for client in clients]),
    ):
        yield table.Row(part=part, what=what, value=max(numbers) / spent / 1e3, unit="kB/s", bar=most)
    own, robots = (100.0 * (b - a) / spent for a, b in zip(before, after, strict=True))
    yield table.Row(part=part, what="server", value=own, unit="% of a core", bar=25.0)
    yield table.Row(part=part, what="robots' processes", value=robots, unit="% of a core")
    for client in clients:
        client.close()


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
    options.add_argument("--people", type=int, default=2, help="how many people are at pages (%(default)s)")
    options.add_argument("--seconds", type=float, default=60.0, help="how long to measure (%(default)s)")
    options.add_argument("--agent", default="frontier", help="the robot's agent (%(default)s)")
    options.add_argument("--json", action="store_true", help="JSON instead of a table")
    given = options.parse_args()
    table.put(list(rows(given.people, given.seconds, given.agent)), as_json=given.json)


if __name__ == "__main__":
    main()
