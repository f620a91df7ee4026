"""A folder with one of each file that hthor reads, small and sound, to be damaged in copies."""

from __future__ import annotations

import shutil
from pathlib import Path

import msgspec

from hthor import calibration, humans, jsonio, tasks, world
from hthor.eval.config.options import EvalOptions
from hthor.eval.planning.resolve import resolve
from hthor.eval.records import find
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.runner import experiment, fault_report, progress
from hthor.tasks.suite import encode_suite, make_suite
from hthor.tasks.suites import commitment
from hthor.tasks.suites.commitment import Commitment, Revealed, Salt

ROOT = Path(__file__).resolve().parents[2]
SALT = "5d41402abc4b2a76b9719d911017c592a1b2c3d4e5f60718293a4b5c6d7e8f90"
_SUBMITTED = "from hthor.types import Action\n\n\nclass Agent:\n    def begin(self, briefing): ...\n\n"
_SUBMITTED += "    def act(self, observation):\n        return Action()\n"


def make(folder: Path) -> Path:
    """Fill the folder; plays three short trials with no robot and with the oracle."""
    few = [one for one in tasks.load_suite("smoke").tasks if one.house == "hazel"][:3]
    short = tuple(msgspec.structs.replace(one, time_limit=15.0, t_star=10.0) for one in few)
    suite = make_suite("few", 1, short)
    jsonio.write(folder / "few.json", encode_suite(suite))
    options = EvalOptions(
        agent=("silent", "oracle"), suite=str(folder / "few.json"), jobs=1, out=folder / "runs", control=False
    )
    list(experiment.run_experiment(resolve(options), lambda _: progress.Silent()))
    jsonio.write(folder / "runs" / "oracle" / "isolation.json", jsonio.pretty({"level": "L2", "landlock_abi": 4}))
    _faults(folder / "runs" / "oracle")
    _official(folder / "official", suite)
    _people(folder)
    shutil.copy(ROOT / "hthor" / "houses" / "data" / "hazel.json", folder / "house.json")
    shutil.copytree(ROOT / "leaderboard", folder / "board")
    jsonio.write(folder / "submissions" / "mine" / "agent.py", _SUBMITTED.encode())
    jsonio.write(folder / "submissions" / "mine" / "submission.json", jsonio.pretty({"name": "Mine"}))
    shutil.copy(Path(world.__file__).parent / "robots" / "scout.py", folder / "my_robot.py")
    shutil.copy(ROOT / "examples" / "put_away.py", folder / "put_away.py")
    return folder


def _faults(run: Path) -> None:
    """What a run keeps of a trial in which an agent failed."""
    spec = find.find_trial(RunFolder(run), "0").spec
    key = find.find_trial(RunFolder(run), "0").key
    failure = fault_report.Failure(seat="robot", agent="oracle", kind="raised", tick=3, time_s=0.3, detail="lost")
    left = fault_report.FaultReport(
        key=key, task=spec.task.id, session=spec.session, index=spec.index, failures=(failure,)
    )
    jsonio.write(run / fault_report.FOLDER / f"{key}.json", jsonio.pretty(left))


def _official(folder: Path, suite: tasks.Suite) -> None:
    """A suite with its commitment and the salt."""
    files = {"suite.json": encode_suite(suite)}
    held = Commitment(
        name="few",
        salt=Salt(SALT).commitment(),
        houses=1,
        tasks=len(suite.tasks),
        suite_sha256=suite.sha256,
        files=commitment.hash_files(files),
        made_with={},
    )
    jsonio.write(folder / "suite.json", files["suite.json"])
    jsonio.write(folder / commitment.COMMITMENT, jsonio.pretty(held))
    jsonio.write(folder / commitment.REVEALED, jsonio.pretty(Revealed(name="few", salt=SALT)))
    jsonio.write(folder.parent / "salt.txt", f"{SALT}\n".encode())


def _people(folder: Path) -> None:
    """A population, a kind of people, and what a calibration aims at."""
    base = Path(humans.__file__).parent
    for name in ("populations/paper.json", "populations/paper.npz", "population/kinds/slow.json"):
        shutil.copy(base / name, folder / Path(name).name)
    shutil.copy(Path(calibration.__file__).parent / "targets" / "paper.json", folder / "targets.json")
