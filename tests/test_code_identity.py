"""The hash of code: spelling and place do not count, everything that can move a score does."""

from __future__ import annotations

import ast
import cProfile
import gc
import random
import shutil
from pathlib import Path
from typing import Any

import eval_fakes
import pytest

from hthor import code_identity, plugins, tasks
from hthor.code_identity import PICTURES, SIMULATION, Sources, syntax
from hthor.eval.records import scored_trial, trial_record
from hthor.eval.results import estimates, paired_difference, pairing
from hthor.trials import TrialRunner, sessions, trial_runner

_OWN = (("human model", "proxy"), ("agent", "frontier"), ("robot", "scout"))
ROOTS = (
    *(trial_runner.__name__, trial_record.__name__),
    *(plugins.module_name("task kind", name) for name in ("mobile_manipulation", "object_goal_navigation")),
    *(plugins.module_name(sort, name) for sort, name in _OWN),
)
SCORING = (
    *code_identity.roots("scoring"),
    *(plugins.module_name("metric", name) for name in plugins.names("metric")),
)


@pytest.fixture(scope="module")
def sources() -> Sources:
    return Sources()


@pytest.fixture(scope="module")
def whole(sources: Sources) -> str:
    return sources.sha256(ROOTS)


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    """The package's sources in another place."""
    place = tmp_path / "hthor"
    shutil.copytree(
        code_identity.PACKAGE, place, ignore=shutil.ignore_patterns("__pycache__", "data", "unseen", "suites")
    )
    return place


def edited(sources: Sources, changes: dict[str, str]) -> Sources:
    """The same sources with other text in these modules."""
    other = Sources()
    other._read = dict(sources._read)
    for name, text in changes.items():
        path = sources._path(name)
        assert path is not None
        other._read[name] = syntax.parse(name, path, sources._path, text.encode())
    return other


def text_of(sources: Sources, name: str) -> str:
    path = sources._path(name)
    assert path is not None
    return path.read_text(encoding="utf-8")


class _Annotated(ast.NodeTransformer):
    """Other docstrings, other annotations of functions."""

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        self.generic_visit(node)
        node.returns = ast.Constant("Anything")
        for one in (*node.args.args, *node.args.kwonlyargs):
            one.annotation = ast.Constant("Anything")
        node.body.insert(0, ast.Expr(ast.Constant("Says what it does in other words.")))
        return node


class _Changed(ast.NodeTransformer):
    """One number, chosen by its place, is another."""

    def __init__(self, which: int) -> None:
        self.left = which
        self.line = 0

    def visit_Constant(self, node: ast.Constant) -> ast.AST:
        if type(node.value) not in (int, float):
            return node
        self.left -= 1
        if self.left != -1:
            return node
        self.line = node.lineno
        return ast.copy_location(ast.Constant(node.value * 2 + 1), node)


def numbers(text: str) -> int:
    """How many numbers stand in a module where they do something: not in what only type checkers read."""
    tree = ast.parse(text)
    return sum(isinstance(node, ast.Constant) and type(node.value) in (int, float) for node in ast.walk(tree))


def mutated(text: str, which: int) -> str:
    return ast.unparse(ast.fix_missing_locations(_Changed(which).visit(ast.parse(text))))


@pytest.mark.parametrize("every", [4, pytest.param(1, marks=pytest.mark.nightly)])
def test_spelling_does_not_count(sources: Sources, whole: str, every: int) -> None:
    """Counted modules rewritten without comments and layout, with other docstrings and annotations."""
    other = {
        name: "# a comment\n"
        + ast.unparse(ast.fix_missing_locations(_Annotated().visit(ast.parse(text_of(sources, name)))))
        for name in sorted(sources.closure(ROOTS))[::every]
    }
    assert edited(sources, other).sha256(ROOTS) == whole


def test_place_does_not_count(copy: Path, whole: str) -> None:
    """A module with another name in another package, imported as a module and by what is in it."""
    for old, new in (
        ("hthor.world.perception.visibility", "hthor.world.sensing.visibility"),
        ("hthor.seeds", "hthor.randomness"),
    ):
        _move(copy, old, new)
    moved = Sources(copy)
    assert moved.module("hthor.world.perception.visibility") is None
    assert moved.module("hthor.seeds") is None
    assert moved.sha256(ROOTS) == whole


class _Moved(ast.NodeTransformer):
    """A module's importers, after it went from one place to another."""

    def __init__(self, old: str, new: str) -> None:
        self.old, self.new = old, new
        self.package, self.name = old.rsplit(".", 1)
        self.room, self.called = new.rsplit(".", 1)
        self.is_bound = False

    def visit_ImportFrom(self, node: ast.ImportFrom) -> Any:
        if node.module == self.old:
            return ast.ImportFrom(self.new, node.names, 0)
        if node.module != self.package or self.name not in [alias.name for alias in node.names]:
            return node
        self.is_bound = True
        others = [alias for alias in node.names if alias.name != self.name]
        mine = [ast.alias(self.called, alias.asname) for alias in node.names if alias.name == self.name]
        return [*([ast.ImportFrom(node.module, others, 0)] if others else []), ast.ImportFrom(self.room, mine, 0)]

    def visit_Name(self, node: ast.Name) -> ast.AST:
        return ast.Name(self.called, node.ctx) if node.id == self.name and self.is_bound else node


def _move(root: Path, old: str, new: str) -> None:
    """Move a module and mend the imports of it, as an editor would."""
    move = _Moved(old, new)
    place = root.parent.joinpath(*move.room.split("."))
    place.mkdir(exist_ok=True)
    (place / "__init__.py").touch()
    shutil.move(root.parent.joinpath(*old.split(".")).with_suffix(".py"), place / f"{move.called}.py")
    for path in root.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        if f"{move.package} import" in text or old in text:
            moved = _Moved(old, new).visit(ast.parse(text))
            path.write_text(ast.unparse(ast.fix_missing_locations(moved)), encoding="utf-8")


@pytest.mark.parametrize("every", [4, pytest.param(1, marks=pytest.mark.nightly)])
def test_every_number_of_every_counted_module_counts(sources: Sources, every: int) -> None:
    """One number changed in each module changes what that module says."""
    for name in sorted(sources.closure(ROOTS))[::every]:
        text = text_of(sources, name)
        count = numbers(text)
        if count:
            before = sources.module(name)
            after = edited(sources, {name: mutated(text, random.Random(name).randrange(count))}).module(name)
            assert before is not None
            assert after is not None
            assert before.tokens != after.tokens or before.part != after.part, name


@pytest.mark.parametrize("mutations", [8, pytest.param(30, marks=pytest.mark.nightly)])
def test_what_one_module_says_reaches_the_hash(sources: Sources, whole: str, mutations: int) -> None:
    """Mutations drawn from all numbers of all counted modules."""
    texts = {name: text_of(sources, name) for name in sources.closure(ROOTS)}
    drawn = random.Random("mutations").sample(
        [(name, which) for name, text in texts.items() for which in range(numbers(text))], mutations
    )
    for name, which in drawn:
        assert edited(sources, {name: mutated(texts[name], which)}).sha256(ROOTS) != whole, (name, which)


def test_pictures_count_only_where_they_are_asked_for(sources: Sources, whole: str) -> None:
    drawn = sources.sha256(ROOTS, (SIMULATION, PICTURES))
    for name in ("hthor.looks.furniture.beds", "hthor.world.rendering.shading"):
        text = text_of(sources, name)
        other = edited(sources, {name: mutated(text, numbers(text) // 2)})
        assert other.sha256(ROOTS) == whole
        assert other.sha256(ROOTS, (SIMULATION, PICTURES)) != drawn


def test_processes_and_printing_do_not_count(sources: Sources, whole: str) -> None:
    for name in ("hthor.guest.host.channel", "hthor.report.terminal.result_tables", "hthor.commands.eval.evaluate"):
        assert name not in sources.closure(ROOTS)


def test_switching_an_import_counts(sources: Sources) -> None:
    """Two modules that both count have something of the same name: taking it from the other is another program."""
    text = text_of(sources, "hthor.eval.metrics.definitions.success")
    line = "from hthor.eval.metrics.definitions import time_spent"
    assert line in text
    other = text.replace(line, line.replace("time_spent", "trust as time_spent"))
    changed = edited(sources, {"hthor.eval.metrics.definitions.success": other})
    assert changed.sha256(SCORING) != sources.sha256(SCORING)


def test_what_only_judges_trials_counts_apart(sources: Sources, whole: str) -> None:
    """A change of metrics or statistics changes no trial, and another scoring version."""
    judging = ("hthor.eval.metrics", "hthor.eval.statistics", "hthor.eval.results", "hthor.eval.comparison")
    counted = sources.closure([*code_identity.roots("trial"), *ROOTS])
    assert not [name for name in counted if name.startswith((*judging, "hthor.report", "hthor.leaderboard"))]
    for name in ("metrics.definitions.time_spent", "statistics.intervals", "results.estimates", "records.attempts"):
        module = f"hthor.eval.{name}"
        other = edited(sources, {module: f"{text_of(sources, module)}\nMORE = 1\n"})
        assert other.sha256(SCORING) != sources.sha256(SCORING), name
        assert other.sha256(ROOTS) == whole, name


def test_everything_that_scoring_runs_counts(sources: Sources) -> None:
    """Trials are scored under a profiler: only the record's own fields are from outside of the counted modules."""
    dealt = eval_fakes.run_of(20)[1]
    played = [one for session in dealt for one in eval_fakes.records(session)]

    def judge() -> None:
        scored = [scored_trial.score(one) for one in played]
        estimates.estimate_metrics(scored)
        estimates.trust_by_trial(scored)
        paired_difference.paired_difference(pairing.pair_trials(scored, scored).pairs, "sr")

    called = _called(judge)
    assert called > {"hthor.eval.metrics.trial_metrics", "hthor.eval.statistics.intervals"}
    assert called - {pairing.__name__, scored_trial.__name__, trial_record.__name__} <= set(sources.closure(SCORING))


def test_a_part_is_one_of_three(sources: Sources) -> None:
    with pytest.raises(ValueError, match="CODE_PART is 'poems'; valid: 'pictures', 'simulation', 'tools'"):
        edited(sources, {"hthor.rules": 'CODE_PART = "poems"\n'})


def test_a_root_that_is_not_there_is_refused(sources: Sources) -> None:
    with pytest.raises(ValueError, match=r"no module hthor\.ruels"):
        sources.sha256(["hthor.ruels"])


def test_a_circle_of_modules_has_a_hash(tmp_path: Path) -> None:
    root = tmp_path / "round"
    root.mkdir()
    (root / "__init__.py").touch()
    (root / "a.py").write_text("from round import b\nX = 1\ndef f(): return b.g()\n")
    (root / "b.py").write_text("def g():\n    from round import a\n    return a.X\n")
    first = Sources(root).sha256(["round.a"])
    (root / "b.py").write_text("def g():\n    from round import a\n    return a.X + 1\n")
    assert Sources(root).sha256(["round.a"]) != first


@pytest.mark.parametrize(
    ("suite", "agent", "robot", "model"),
    [
        ("smoke", "frontier", "scout", "proxy"),
        ("navigation", "oracle", "scout", "greedy"),
        ("tidy", "oracle", "tender", "proxy"),
        ("carry", "oracle", "tender", "random"),
        ("vln", "frontier", "scout", "proxy"),
    ],
)
def test_everything_that_a_trial_runs_counts(sources: Sources, suite: str, agent: str, robot: str, model: str) -> None:
    """A trial is played under a profiler: no function outside of the counted modules is called."""
    chosen = tasks.load_suite(suite)
    stage = TrialRunner()
    trial = sessions.make_sessions(chosen, agent=agent, robot=robot, humans=model)[0].trials[0]
    with stage.enter(sessions.make_sessions(chosen, agent=agent, robot=robot, humans=model)[0]) as company:
        world = stage.world(trial)
        called = _called(lambda: stage.run(company, trial, world))
    roots = [trial_runner.__name__, trial_record.__name__]
    own = (("human model", model), ("agent", agent), ("robot", robot), ("task kind", trial.task.kind))
    counted = set(sources.closure([*roots, *(plugins.module_name(sort, name) for sort, name in own)]))
    assert called > {"hthor.episode.episode", "hthor.world.simulation"}
    assert called <= counted


def _called(act: Any) -> set[str]:
    """Names of our modules of which a function is called; a module's own first run does not count."""
    profile = cProfile.Profile(builtins=False)
    gc.collect()
    gc.disable()  # generators that earlier tests left would be closed, and so called, while this one is watched
    try:
        profile.runcall(act)
    finally:
        gc.enable()
    codes = [entry.code for entry in profile.getstats()]
    files = {code.co_filename for code in codes if not isinstance(code, str) and code.co_name != "<module>"}
    paths = [Path(file) for file in files if Path(file).is_relative_to(code_identity.PACKAGE)]
    parts = [path.relative_to(code_identity.PACKAGE.parent).with_suffix("").parts for path in paths]
    return {".".join(one[:-1] if one[-1] == "__init__" else one) for one in parts}


def test_what_robots_bring_counts_apart() -> None:
    """A run with a robot and its control without one have the same code."""
    assert code_identity.agent_sha256("frontier") != code_identity.agent_sha256("oracle")
    kinds = ["mobile_manipulation"]
    assert code_identity.code_sha256(["proxy"], kinds) != code_identity.code_sha256(["greedy"], kinds)
    assert code_identity.code_sha256(["proxy"], kinds) != code_identity.code_sha256(["proxy"], [*kinds, "tidying_up"])
    assert code_identity.code_sha256(["my_human.py"], kinds) == code_identity.code_sha256(["other"], kinds)


def test_a_hash_that_is_kept_is_the_one_that_is_worked_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    first = code_identity.agent_sha256("oracle")
    (kept,) = (tmp_path / "hthor" / "code").iterdir()
    assert kept.read_text() == first == code_identity.agent_sha256("oracle")
    kept.write_text("cut off")
    assert code_identity.agent_sha256("oracle") == first
