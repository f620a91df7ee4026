"""A network with delays between a page and its server, in this process."""

from __future__ import annotations

import asyncio
import random
import threading
from typing import Any

HOST = "127.0.0.2"
"""Where a relay listens, on the port of its server, so that addresses differ in nothing else."""


class Relay:
    """Passes on every byte in its order, each piece after a delay of its own; a context manager.

    Args:
        port: of the server, on 127.0.0.1. round_trip_s: [s] the mean time of a piece there and back.
        jitter: how much the delay of a piece differs from the mean, as a part of it.
    """

    def __init__(self, port: int, round_trip_s: float, jitter: float = 0.5) -> None:
        self._port, self._delay, self._jitter = port, round_trip_s / 2, jitter
        self._draw = random.Random(0)
        self.passed = [0, 0]
        self._held_until = 0.0  # on the clock of the loop
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)

    @property
    def address(self) -> str:
        return f"http://{HOST}:{self._port}"

    def __enter__(self) -> Relay:
        self._thread.start()
        self._run(self._start())
        return self

    def __exit__(self, *_: object) -> None:
        self._run(self._stop())
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    def hold(self, seconds: float) -> None:
        """Let nothing through for so long, as a network does that is gone for a while."""
        self._loop.call_soon_threadsafe(self._hold, seconds)

    def cut(self) -> None:
        """Close every connection; the next ones are accepted as before."""
        self._loop.call_soon_threadsafe(self._cut)

    def _hold(self, seconds: float) -> None:
        self._held_until = self._loop.time() + seconds

    def _cut(self) -> None:
        for sink in self._sinks:
            sink.close()

    def _run(self, work: Any) -> None:
        asyncio.run_coroutine_threadsafe(work, self._loop).result(10.0)

    async def _start(self) -> None:
        self._tasks: set[asyncio.Task[None]] = set()
        self._sinks: list[asyncio.StreamWriter] = []
        self._server = await asyncio.start_server(self._accept, HOST, self._port)

    async def _stop(self) -> None:
        self._server.close()
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        for sink in self._sinks:
            sink.close()
        await asyncio.gather(*(sink.wait_closed() for sink in self._sinks), return_exceptions=True)

    async def _accept(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        there = await asyncio.open_connection("127.0.0.1", self._port)
        self._sinks += (writer, there[1])
        for direction, (source, sink) in enumerate(((reader, there[1]), (there[0], writer))):
            pieces: asyncio.Queue[tuple[float, bytes]] = asyncio.Queue()
            for work in (self._take(source, pieces), self._give(pieces, sink, direction)):
                task = self._loop.create_task(work)
                self._tasks.add(task)
                task.add_done_callback(self._tasks.discard)

    async def _take(self, source: asyncio.StreamReader, pieces: asyncio.Queue[tuple[float, bytes]]) -> None:
        """Read pieces, and decide when each arrives; none overtakes another."""
        last = 0.0
        while True:
            try:
                data = await source.read(65_536)
            except ConnectionError:
                data = b""
            delay = self._delay * (1.0 + self._jitter * self._draw.uniform(-1.0, 1.0))
            last = max(last, self._loop.time() + delay)
            await pieces.put((last, data))
            if not data:
                return

    async def _give(self, pieces: asyncio.Queue[tuple[float, bytes]], sink: asyncio.StreamWriter, way: int) -> None:
        while True:
            due, data = await pieces.get()
            while (wait := max(due, self._held_until) - self._loop.time()) > 0.0:
                await asyncio.sleep(wait)
            if not data:
                sink.close()
                return
            self.passed[way] += len(data)
            sink.write(data)
            try:
                await sink.drain()
            except ConnectionError:
                return
