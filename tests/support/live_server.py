"""A session as a process that can be killed: `python live_server.py FOLDER PORT FASTER [NAME=VALUE ...]`.

Serves the smoke suite's first trials to living people, ``FASTER`` times faster than real time. Writes the tokens of the
seats in the order of the seats, one line each. With ``page=yes`` browsers may come; their houses lack the light that
takes long to compute.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np

from hthor.eval.config.options import EvalOptions
from hthor.eval.runner.progress import Silent
from hthor.live.gltf import house_file
from hthor.live.run import LiveRun
from hthor.world.rendering.scene.baked_light import BakedLight


def main(folder: str, port: str, faster: str, *options: str) -> None:
    speed = float(faster)
    given = dict(one.split("=") for one in options)
    chosen = EvalOptions(
        agent=(given.get("agent", "none"),),
        humans=(given.get("humans", "live"),),
        suite="smoke",
        house=(given["house"],) if "house" in given else (),
        limit=int(given.get("limit", "2")),
        out=Path(folder),
    )
    with LiveRun(
        chosen,
        port=int(port),
        page=given.get("page") == "yes",
        tell=lambda words: sys.stderr.write(words + "\n"),
        now=lambda: speed * time.perf_counter(),
        sleep=lambda seconds: time.sleep(seconds / speed),
    ) as run:
        for token in run.server.tokens.values():
            sys.stdout.write(token + "\n")
        sys.stdout.flush()
        run.play(lambda _: Silent())


if __name__ == "__main__":
    if "page=yes" in sys.argv:
        BakedLight._light = lambda self, points, normals: (  # type: ignore[assignment,method-assign]
            np.full((len(points), 3), 0.8),
            np.zeros(len(points), bool),
        )
        BakedLight._openness = lambda self, points, normals: (  # type: ignore[assignment,method-assign]
            np.ones(len(points)),
            np.zeros(len(points), bool),
        )
    else:
        house_file._make = lambda *_: b""
    main(*sys.argv[1:])
