"""A program that takes pictures in other processes and threads, before and after it took one with OpenGL itself.

It prints JSON: for "before" or "after", the way and the profile, what came of it: "drew", or an error's class and
sentence, or "hangs".
"""

from __future__ import annotations

import json
import multiprocessing
import os
import select
import signal
import sys
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import world_house

from hthor.world import World

PROFILES, SIZE = ("fast", "nice"), (16, 16)
WAYS = ("fork", "fork with a world", "spawn", "thread", "thread pool")
_PATIENCE_S = 120.0


def picture(world: World, profile: str) -> str:
    try:
        return "drew" if world.human.rgb(SIZE, profile).shape == (16, 16, 3) else "no picture"
    except Exception as error:
        return f"{type(error).__name__}: {error}"


def fresh_picture(profile: str) -> str:
    return picture(World(world_house.house()), profile)


def forked(draw: Callable[[], str]) -> str:
    """What a forked process says that then ends as programs do, exit handlers and all."""
    ours, theirs = os.pipe()
    pid = os.fork()
    if not pid:
        os.write(theirs, draw().encode())
        sys.exit()
    os.close(theirs)
    said = b""
    while select.select([ours], [], [], _PATIENCE_S)[0] and (more := os.read(ours, 4096)):
        said += more
    os.close(ours)
    over = threading.Timer(_PATIENCE_S, os.kill, (pid, signal.SIGKILL))
    over.start()
    _, status = os.waitpid(pid, 0)
    over.cancel()
    return said.decode() if status == 0 else f"{said.decode()} and hangs or dies: {status}"


def spawned(profile: str) -> str:
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return pool.apply_async(fresh_picture, (profile,)).get(_PATIENCE_S)


def threaded(world: World, profile: str, threads: int) -> str:
    with ThreadPoolExecutor(threads) as pool:
        said = set(pool.map(lambda _: picture(world, profile), range(2 * threads)))
    return ", ".join(said)


def while_a_thread_draws(world: World, profile: str) -> str:
    """What a process says that was forked in the middle of another thread's picture."""
    inside, done = threading.Event(), threading.Event()

    def draw() -> None:
        with world.pictures._images._drawing(profile):
            inside.set()
            done.wait()

    thread = threading.Thread(target=draw)
    thread.start()
    inside.wait()
    said = forked(lambda: picture(world, "fast"))
    done.set()
    thread.join()
    return said


def main() -> None:
    world = World(world_house.house())
    found = {}
    for when in ("before", "after"):
        for profile in PROFILES:
            found[when, "fork", profile] = forked(lambda profile=profile: fresh_picture(profile))
            found[when, "fork with a world", profile] = forked(lambda profile=profile: picture(world, profile))
            found[when, "spawn", profile] = spawned(profile)
        for profile in PROFILES:
            found[when, "thread", profile] = threaded(world, profile, 1)
            found[when, "thread pool", profile] = threaded(world, profile, 3)
        picture(world, "nice")
    for profile in PROFILES:
        found["after", "fork while a thread draws", profile] = while_a_thread_draws(world, profile)
    found["after", "still", "nice"] = picture(world, "nice")
    sys.stdout.write(json.dumps([[*case, said] for case, said in found.items()]))


if __name__ == "__main__":
    main()
