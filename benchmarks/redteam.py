"""``python -m benchmarks.redteam``: every hostile agent in a real, scored trial at each level, as an unprivileged user.

A table of agent, level and what came of it. "unharmed" is an attempt that came to nothing, after which the agent played
on. The exit code is 1 when one of them got what it wanted, or did otherwise than expected.
"""

from __future__ import annotations

import argparse
import json
import sys
from typing import Any

from tests.redteam import nobody
from tests.redteam.agents import HONEST, HOSTILE, NO_FAULT, Case


def verdict(one: dict[str, Any], idle: dict[str, Any], case: Case) -> str:
    """What is not as it should be, empty when all is."""
    wrong = {
        "it got something": one["breach"],
        f"unexpected end, expected {' or '.join(case.kinds)}": (one["kind"] or NO_FAULT) not in case.kinds,
        "the fault is not counted": one["counted"] != ({one["kind"]: 1} if one["kind"] else {}),
        "its trial is not scored": one["scored"] != idle["scored"],
        "the person did otherwise": one["person"] != idle["person"],
        "files have changed": one["changed"],
    }
    return "; ".join(words for words, holds in wrong.items() if holds)


def main() -> None:
    """Play and print."""
    options = argparse.ArgumentParser(prog="python -m benchmarks.redteam", description=__doc__.split("\n\n")[0])
    options.add_argument("--levels", default="L2,L3")
    options.add_argument("--json", action="store_true", help="all that is known of each, as JSON")
    options.add_argument("names", nargs="*", help="only these agents")
    given = options.parse_args()
    done = nobody.scored(given.levels, *given.names)
    if done.returncode:
        sys.exit(done.stderr)
    found = json.loads(done.stdout)
    if given.json:
        print(done.stdout)
    for level, why in found["missing"].items():
        print(f"{level}: {why}", file=sys.stderr)
    cases, bad = {case.name: case for case in (*HOSTILE, *HONEST)}, 0
    idle = {one["level"]: one for one in found["agents"] if one["name"] == "nop"}
    rows: dict[str, dict[str, str]] = {}
    for one in found["agents"]:
        if one["name"] == "nop":
            continue
        wrong = verdict(one, idle[one["level"]], cases[one["name"]])
        bad += bool(wrong)
        last = one["detail"].strip().splitlines()[-1][:70] if one["detail"].strip() else ""
        told = f"FAILED: {wrong}" if wrong else one["kind"] or "unharmed"
        rows.setdefault(one["name"], {})[one["level"]] = told + (f" ({last})" if last and one["level"] == "L2" else "")
    if not given.json:
        for name, by_level in rows.items():
            print(f"{name:34s}" + "  ".join(f"{level}: {told}" for level, told in by_level.items()))
    hostile = {case.name for case in HOSTILE}
    played = [one for one in found["agents"] if one["name"] in hostile]
    faults = sum(bool(one["kind"]) for one in played)
    print(
        f"uid {found['uid']}: {len(played)} scored trials of {len({one['name'] for one in played})} hostile agents, "
        f"{faults} with a named fault, {len(played) - faults} unharmed; {bad} not as they should be"
    )
    sys.exit(bool(bad) or not found["intact"])


if __name__ == "__main__":
    main()
