"""The engine on a Ray cluster of two nodes, with made-up trials; needs the extra hthor[cluster]."""

from __future__ import annotations

import functools
import importlib.util
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import eval_fakes as fakes
import guest_fakes
import pytest

from hthor.errors import AgentError, HthorError, MissingExtra
from hthor.eval.records.run_folder import RunFolder
from hthor.eval.runner import engines, progress, run
from hthor.trials import robot_team

WITHOUT = importlib.util.find_spec("ray") is None
needs_ray = pytest.mark.skipif(WITHOUT, reason="needs Ray: pip install 'hthor[cluster]'")
NODES = """
import sys
from ray.cluster_utils import Cluster
cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1, "include_dashboard": False})
second = cluster.add_node(num_cpus=1)
print(cluster.address, flush=True)
for line in sys.stdin:
    cluster.remove_node(second, allow_graceful=False)
    second = cluster.add_node(num_cpus=1)
    print("killed", flush=True)
cluster.shutdown()
"""


@pytest.mark.skipif(not WITHOUT, reason="Ray is installed")
def test_without_ray_one_sentence_says_what_to_install():
    with pytest.raises(MissingExtra, match=r"--engine ray needs .*: pip install 'hthor\[cluster\]'\."):
        engines.find_engine("ray")


def test_unknown_engines_and_needless_addresses_are_refused():
    with pytest.raises(HthorError, match=r"unknown engine 'rey'. Did you mean 'ray'\? Valid: local, ray\."):
        engines.find_engine("rey")
    with pytest.raises(HthorError, match=r"--address 10\.0\.0\.1:6379: the engine 'local' takes no address"):
        engines.find_engine("local", address="10.0.0.1:6379")


AGENT = """
class Agent:
    {line}
    def begin(self, briefing): ...
    def act(self, observation): ...
"""


@pytest.mark.parametrize(("line", "gpus"), [("gpus = 0.25", 0.25), ("gpus: int = 1", 1.0), ("pass", 0.0)])
def test_a_class_says_how_much_of_a_gpu_it_wants(line: str, gpus: float, tmp_path: Path):
    (tmp_path / "agent.py").write_text(AGENT.format(line=line))
    assert robot_team.form_team(["scout"] * 2, [str(tmp_path / "agent.py"), "silent"]).gpus == gpus


def test_a_wish_that_is_no_number_is_refused(tmp_path: Path):
    (tmp_path / "agent.py").write_text(AGENT.format(line="gpus = 'all'"))
    with pytest.raises(
        AgentError, match=r"agent\.py: Agent\.gpus must be a number from 0 on, such as 0\.25 or 1, got 'all'"
    ):
        robot_team.load_agent_info(str(tmp_path / "agent.py"))


@pytest.fixture(scope="module")
def nodes() -> Iterator[subprocess.Popen[str]]:
    """A cluster of two nodes on this machine. A line on its input has the second one killed, and another one begun."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), *sys.path])}
    with subprocess.Popen(
        [sys.executable, "-c", NODES],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        env=environment,
    ) as nodes:
        assert nodes.stdout is not None
        yield nodes
        nodes.communicate()


@pytest.fixture(scope="module")
def address(nodes: subprocess.Popen[str]) -> str:
    assert nodes.stdout is not None
    return nodes.stdout.readline().strip()


def _start(folder: Path, count: int, address: str, *more: str) -> subprocess.Popen[str]:
    words = [sys.executable, fakes.__file__, "clustered", str(folder), str(count), address, *more]
    return subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def _lines(folder: Path) -> list[bytes]:
    path = folder / "trials.jsonl"
    return sorted(path.read_bytes().splitlines(keepends=True)) if path.exists() else []


def _actors() -> list[int]:
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            if b"ray::Actor" in (folder / "cmdline").read_bytes():
                found.append(int(folder.name))
        except OSError:
            continue
    return found


@needs_ray
def test_two_nodes_give_the_local_records_though_actors_are_killed(address: str, tmp_path: Path):
    plan, dealt = fakes.run_of(200)
    local = run.run_evaluation(
        plan, dealt, fakes.player, folder=RunFolder(tmp_path / "local"), engine=fakes.Here(), watcher=progress.Silent()
    )
    with _start(tmp_path / "ray", 200, address) as process:
        for aim in (20, 60):
            end = time.monotonic() + 900.0
            while len(_lines(tmp_path / "ray")) < aim and time.monotonic() < end and process.poll() is None:
                time.sleep(0.01)
            for actor in _actors()[:1]:
                os.kill(actor, signal.SIGKILL)
        _, words = process.communicate(timeout=900)
    assert process.returncode == 0, words
    assert _lines(tmp_path / "ray") == _lines(tmp_path / "local")
    assert local.counts.trials == 200
    assert not _actors()


@needs_ray
def test_a_node_that_is_lost_costs_guests_nothing(nodes: subprocess.Popen[str], address: str, tmp_path: Path):
    agent = guest_fakes.write(tmp_path / "agent")
    plan, dealt = fakes.run_of(60)
    make = functools.partial(guest_fakes.player, str(agent), "auto")
    local = engines.find_engine("local", jobs=2)
    run.run_evaluation(plan, dealt, make, folder=RunFolder(tmp_path / "local"), engine=local, watcher=progress.Silent())
    with _start(tmp_path / "ray", 60, address, str(agent)) as process:
        end = time.monotonic() + 900.0
        while len(_lines(tmp_path / "ray")) < 15 and time.monotonic() < end and process.poll() is None:
            time.sleep(0.01)
        assert nodes.stdin is not None
        assert nodes.stdout is not None
        nodes.stdin.write("kill\n")
        nodes.stdin.flush()
        assert nodes.stdout.readline() == "killed\n"
        _, words = process.communicate(timeout=900)
    assert process.returncode == 0, words
    assert _lines(tmp_path / "ray") == _lines(tmp_path / "local")
    replays = json.loads((tmp_path / "ray" / "result.json").read_bytes())["effort"]["replays"]
    assert replays >= 1


@needs_ray
def test_an_address_where_nobody_is_gets_one_sentence(tmp_path: Path):
    with _start(tmp_path / "run", 10, "127.0.0.1:9") as process:
        _, words = process.communicate(timeout=900)
    assert process.returncode == 2
    assert words.splitlines()[-1].startswith("--engine ray --address '127.0.0.1:9'")
