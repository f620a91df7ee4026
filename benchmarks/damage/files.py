"""Which files are damaged in which ways, and the commands that read each of them."""

from __future__ import annotations

import random
import shutil
from pathlib import Path

from msgspec import Struct

from benchmarks.damage import spoiling
from benchmarks.damage.asking import Said, ask
from benchmarks.damage.spoiling import Spoil

RUN = "runs/oracle"
TASK = "smoke/hazel/manipulation-01"
_RUN_READERS = (
    f"score {RUN}",
    "score runs/silent --all --json",
    "compare runs/silent runs/oracle --json",
    "power runs/silent runs/oracle",
    f"merge {RUN} --out out --json",
    f"leaderboard add {RUN} --board board",
    "eval --agent oracle --suite few.json --out runs/oracle --dry-run",
    f"calibrate --target {RUN} --quick --dry-run --json",
)
_DRAWN = (f"replay {RUN} 0 --out out.png", f"report runs/silent {RUN} --out out --json")
_DRAWING = 0.05
"""Share of the damaged runs that are drawn, which takes seconds."""
_WRITTEN = (
    *("out", "result.json", "leaderboard.json", "index.html", "schema.json", "platform.json", ".lock", ".cache"),
    "revealed.json",
)
"""What commands write themselves; everything else must stay as it is."""


class Target(Struct, frozen=True, kw_only=True):
    """A file, ways to damage it, and command lines that read it."""

    path: str
    spoils: tuple[Spoil, ...]
    readers: tuple[str, ...]
    weight: int = 1


TARGETS = (
    Target(path=f"{RUN}/run.json", spoils=spoiling.JSON, readers=_RUN_READERS, weight=3),
    Target(path=f"{RUN}/result.json", spoils=spoiling.JSON, readers=_RUN_READERS, weight=3),
    Target(path=f"{RUN}/trials.jsonl", spoils=spoiling.LOG, readers=_RUN_READERS, weight=4),
    Target(path=f"{RUN}/isolation.json", spoils=spoiling.JSON, readers=_RUN_READERS),
    Target(path=f"{RUN}/platform.json", spoils=spoiling.JSON, readers=_RUN_READERS),
    Target(path=f"{RUN}/faults", spoils=spoiling.JSON, readers=_DRAWN),
    Target(
        path="few.json",
        spoils=spoiling.SUITE,
        readers=(
            "tasks list few.json --json",
            f"tasks show {TASK} --suite few.json",
            f"tasks draw {TASK} --suite few.json --out out.png",
            "eval --agent silent --suite few.json --dry-run --json",
        ),
        weight=3,
    ),
    Target(
        path="house.json",
        spoils=spoiling.JSON,
        readers=("houses check house.json", "houses show house.json --out out.png", "houses census house.json --json"),
        weight=2,
    ),
    *(
        Target(
            path=f"paper.{ending}",
            spoils=spoils,
            readers=(
                "humans describe ./paper.json --json",
                "humans sample ./paper.npz --n 3 --json",
                "eval --agent silent --suite few.json --humans ./paper.json --dry-run",
                "eval --agent silent --suite few.json --humans proxy@./paper.npz --dry-run",
            ),
        )
        for ending, spoils in (("json", spoiling.JSON), ("npz", spoiling.TABLE))
    ),
    Target(
        path="slow.json",
        spoils=spoiling.JSON,
        readers=(
            "humans describe slow.json",
            "eval --agent silent --suite few.json --humans slow.json --dry-run --json",
        ),
    ),
    Target(path="targets.json", spoils=spoiling.JSON, readers=("calibrate --target targets.json --quick --dry-run",)),
    Target(
        path="board/entries",
        spoils=spoiling.JSON,
        readers=(
            "leaderboard validate --board board",
            "leaderboard validate --board board --fix --json",
            "leaderboard build --board board",
            "leaderboard build --board board --check --json",
            "leaderboard rescore --board board",
        ),
        weight=2,
    ),
    Target(
        path="official/commitment.json",
        spoils=spoiling.JSON,
        readers=("suite verify official --json", "suite reveal official --salt-file salt.txt"),
    ),
    Target(path="official/revealed.json", spoils=spoiling.JSON, readers=("suite verify official",)),
    Target(path="salt.txt", spoils=spoiling.JSON[:4], readers=("suite reveal official --salt-file salt.txt",)),
    Target(
        path="submissions/mine/submission.json",
        spoils=spoiling.JSON,
        readers=("leaderboard check submissions/mine", "leaderboard add runs/oracle --submission submissions/mine"),
    ),
    Target(
        path="my_robot.py",
        spoils=spoiling.SOURCE,
        readers=("eval --robots my_robot.py:silent --suite few.json --dry-run --json",),
    ),
    Target(
        path="put_away.py", spoils=spoiling.SOURCE, readers=("eval --agent oracle --kind put_away.py --dry-run --json",)
    ),
)


class Trial(Struct, frozen=True, kw_only=True):
    """A file that was damaged and read: what was done, and what is wrong with how that ended."""

    path: str
    how: str
    words: str
    code: int
    problems: tuple[str, ...]


def damage(playground: Path, copy: Path, dice: random.Random) -> Trial:
    """Damage one file of a copy of the playground and have one command read it."""
    target = dice.choices(TARGETS, [one.weight for one in TARGETS])[0]
    spoil, words = dice.choice(target.spoils), dice.choice(target.readers).split()
    if target.path.startswith(RUN) and dice.random() < _DRAWING:
        words = dice.choice(_DRAWN).split()
    shutil.copytree(playground, copy)
    path = copy / target.path
    if path.is_dir():
        path = dice.choice(sorted(path.glob("*.json")))
    data = spoil(path.read_bytes(), dice)
    path.write_bytes(data)
    if path.suffix == ".npz" and dice.random() < 0.8:
        document = path.with_suffix(".json")
        document.write_bytes(spoiling.hash_again(document.read_bytes(), data))
    before = contents(copy)
    said = ask(copy, words)
    problems = (*said.problems(), *lost(before, contents(copy), said))
    shutil.rmtree(copy)
    return Trial(path=target.path, how=spoil.__name__, words=" ".join(words), code=said.code, problems=problems)


def contents(folder: Path) -> dict[str, bytes]:
    """Every file of a folder by its path."""
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def lost(before: dict[str, bytes], after: dict[str, bytes], said: Said) -> list[str]:
    """What was there and is not any more, but for what the command is there to write."""
    if "--fix" in said.words or "rescore" in said.words:  # these write the board's entries
        return [f"{name} is gone" for name in before if name not in after]
    told = said.words if "--force" in said.words else ()  # what a user names and forces is the user's to lose
    kept = [name for name in before if name not in told and not any(part in _WRITTEN for part in name.split("/"))]
    return [f"{name} is not as it was" for name in kept if after.get(name) != before[name]]
