"""People by name: populations, kinds, models and files; that all robots meet the same; and where they are not known."""

from __future__ import annotations

import io
import json
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import eval_fakes as fakes
import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from hthor import cli, plugins, rules, tasks
from hthor.errors import HthorError, PopulationError, UnknownName
from hthor.eval.comparison import population_matrix
from hthor.eval.config import human_populations
from hthor.eval.config.human_populations import HumanModelRef
from hthor.eval.config.options import EvalOptions
from hthor.eval.planning import resolve as planning
from hthor.eval.results import result_file
from hthor.eval.runner import experiment, progress, session_runner
from hthor.humans.population import (
    describe,
    kinds,
    parameter_registry,
    parameters,
    participant,
    population_file,
    resolve,
)
from hthor.humans.population.parameters import Parameters
from hthor.humans.population.population import Population, Validity
from hthor.report.terminal import result_tables
from hthor.trials import Sources, TrialRunner, human_team, sessions

pytestmark = pytest.mark.usefixtures("no_workers")

KINDS = ("cautious", "distracted", "fast", "ignores_messages", "over_trusting", "poor_memory", "slow")
MODEL = '''"""A person who stands still; waits for nothing."""
class Model:
    def __init__(self, person): self.person = person
'''


def small(**validity: Any) -> Population:
    """Two draws, fitted to the fake suite of twenty tasks with scouts."""
    its = {
        "suite": "fake",
        "suite_sha256": fakes.suite(20).sha256,
        "settings": human_populations.robot_settings("scout", "own"),
        **validity,
    }
    rows = [[0.4, 0.2], [0.6, 0.3]]
    about: dict[str, Any] = {"purpose": "two draws", "seed": 0, "command": "a test", "validity": Validity(**its)}
    return Population.make("pop", rows, names=("v_pace", "sigma"), **about)


@pytest.fixture
def files(tmp_path: Path) -> Iterator[Path]:
    """A folder with a population, a kind of people and a human model."""
    population_file.save_population(small(), tmp_path / "pop")
    change = {"parameter": "v_pace", "verb": "times", "value": 0.5, "reason": "a test"}
    kind = {"schema": kinds.SCHEMA, "name": "half", "purpose": "half as fast", "reason": "a test", "changes": [change]}
    (tmp_path / "half.json").write_text(json.dumps(kind))
    (tmp_path / "still.py").write_text(MODEL)
    yield tmp_path
    for name in ("still", "fed", "mine"):  # so that the next test may load another file of this name
        sys.modules.pop(f"hthor.humans.models.{name}", None)


# ------------------------------------------------------------------------------------------------------------- words


def test_every_word_finds_people_of_its_own_hash():
    found = {word: resolve.resolve_humans(word) for word in resolve.human_names() if word not in ("recorded", "replay")}
    assert found[resolve.default_population()].sha256 == found["proxy"].sha256
    assert len({one.sha256 for one in found.values()}) == len(found) - 1
    assert set(KINDS) <= set(found)
    for word, one in found.items():
        assert one.name == word == one.word
        assert one.purpose
        assert resolve.resolve_humans(word).sha256 == one.sha256


def test_the_proxy_has_the_calibrated_population_once_it_ships(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(population_file, "FOLDER", tmp_path)
    monkeypatch.setattr(population_file, "_shipped", population_file._shipped.__wrapped__)
    assert resolve.default_population() == "literature"
    made = msgspec.structs.replace(small(), name="paper")
    population_file.save_population(made, tmp_path / "paper")
    assert resolve.default_population() == "study"
    for word in ("proxy", "study", "paper"):
        assert resolve.resolve_humans(word).population.sha256 == made.sha256
    for word in ("slow", "greedy"):
        assert resolve.resolve_humans(word).population.name == "paper"
    assert "study" in resolve.human_names()
    assert "paper" not in resolve.human_names(), "a word for them that is still read"
    assert resolve.resolve_humans("paper").name == resolve.resolve_humans("study").name == "study"


def test_files_are_found_by_path_and_again_from_anywhere(files: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(files)
    words = ("pop.npz", "pop.json", "half.json", "still.py", "half.json@pop.npz", "still.py@pop.json", "slow@pop.npz")
    found = [resolve.resolve_humans(word) for word in words]
    assert [one.name for one in found] == ["pop", "pop", "half", "still", "half@pop", "still@pop", "slow@pop"]
    drawn = [population_file.population_name(one.population.name) for one in found]
    assert drawn == ["pop", "pop", resolve.default_population(), resolve.default_population(), *["pop"] * 3]
    monkeypatch.chdir("/")
    for one in found:
        again = resolve.resolve_humans(one.word)
        assert (again.name, again.sha256) == (one.name, one.sha256)
        assert again.participant(0, 3) == one.participant(0, 3)
    assert found[0].sha256 == found[1].sha256
    assert len({one.sha256 for one in found}) == len(found) - 1
    assert type(found[3].make_model(0, 1)).__name__ == "Model"


def test_a_file_that_is_called_like_people_of_ours_is_not_taken_for_them(tmp_path: Path):
    """Their names stand in tables and on pages; a home-made proxy.json must not pass there as the proxy."""
    kind = (Path(kinds.__file__).parent / "fast.json").read_text()
    names = set()
    for name in ("proxy", "study", "cautious", "mine"):
        path = tmp_path / f"{name}.json"
        path.write_text(kind.replace('"name": "fast"', f'"name": "{name}"'))
        names.add(resolve.resolve_humans(str(path)).name)
    assert "mine" in names
    assert not names & {"proxy", "study", "cautious"}
    assert all(re.fullmatch(r"mine|(proxy|study|cautious)-[0-9a-f]{6}", name) for name in names)


def test_the_hash_covers_model_population_and_kind(files: Path):
    still = resolve.resolve_humans(f"{files}/still.py@{files}/pop.npz").sha256
    (files / "still.py").write_text(MODEL + "# changed\n")
    assert resolve.resolve_humans(f"{files}/still.py@{files}/pop.npz").sha256 != still
    before = resolve.resolve_humans(f"{files}/half.json@{files}/pop.npz").sha256
    text = (files / "half.json").read_text()
    (files / "half.json").write_text(text.replace("half as fast", "other words"))
    assert resolve.resolve_humans(f"{files}/half.json@{files}/pop.npz").sha256 == before
    (files / "half.json").write_text(text.replace("0.5", "0.6"))
    assert resolve.resolve_humans(f"{files}/half.json@{files}/pop.npz").sha256 != before


def test_what_a_model_is_made_from_is_in_its_hash(files: Path):
    (files / "fed.py").write_text(MODEL + "WORD = 1\ndef ingredients(source): return {'w': WORD, 'source': source}\n")
    first = resolve.resolve_humans(str(files / "fed.py"))
    module = plugins.loaded("human model", "fed")
    module.WORD = 2
    assert resolve.resolve_humans(str(files / "fed.py")).sha256 != first.sha256


@pytest.mark.parametrize(
    ("word", "hints"),
    [
        ("cautios", ("unknown people 'cautios'. Did you mean 'cautious'?", "pop.npz", "my_kind.json", "my_human.py")),
        ("nowhere.npz", ("nowhere.json: $: cannot be read",)),
        ("nowhere.json", ("nowhere.json: $: cannot be read",)),
        ("nowhere.py", ("unknown human model 'nowhere.py'", "must lead to a Python file")),
        ("slow@literatur", ("unknown population 'literatur'. Did you mean 'literature'?",)),
        ("literature@literature", ("is a population itself",)),
        ("", ("unknown people ''",)),
    ],
)
def test_wrong_words_are_answered(word: str, hints: tuple[str, ...]):
    with pytest.raises(HthorError) as caught:
        resolve.resolve_humans(word)
    for hint in hints:
        assert hint in str(caught.value)


def test_a_model_that_is_made_from_something_else_has_no_population(files: Path):
    text = (
        "def ingredients(source): return {'log': source[-3:]}\nclass Model:\n    def __init__(self, person, source): "
    )
    module = type(sys)("hthor.humans.models.fed")
    exec(text + "self.source = source\n", module.__dict__)
    crew = fakes.crew("helper")
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, module.__name__, module)
        patch.setattr(plugins, "names", lambda _: ("fed", "proxy"))
        patch.setattr(plugins, "load", lambda *_: module.Model)
        patch.setattr(plugins, "summary", lambda *_: "a test")
        found = resolve.resolve_humans(f"fed:{files}/log")
        ref = human_populations.human_model_ref(human_team.form_team([found]), fakes.suite(20), crew)
        assert found.make_model(0, 0).source == str(files / "log")
        assert (
            resolve.resolve_humans(found.word).sha256
            == found.sha256
            != resolve.resolve_humans(f"fed:{files}/pop").sha256
        )
    assert (ref.name, ref.source, ref.population, ref.valid) == ("fed-log", "fed:log", "", True)


# ------------------------------------------------------------------------------------------------------------- kinds


@pytest.mark.parametrize("name", kinds.names())
def test_every_kind_changes_what_it_says_and_gives_its_reasons(name: str):
    kind = kinds.load(name)
    assert kind.purpose
    assert kind.reason
    assert all(change.reason for change in kind.changes)
    base = resolve.resolve_humans(resolve.default_population())
    ours = resolve.resolve_humans(name)
    means, changed = base.population.mean(), {change.parameter for change in kind.changes}
    new = kind.change(means)
    for parameter, value in msgspec.structs.asdict(means).items():
        assert (getattr(new, parameter) != value) == (parameter in changed), parameter
        assert parameters.range_problem(parameter, getattr(new, parameter)) == ""
    for number in range(12):  # the same person but for that: draw and random effects are theirs
        was, now = base.participant(0, number).traits, ours.participant(0, number).traits
        same = [name for name in parameters.parameter_names() if getattr(was, name) == getattr(now, name)]
        assert set(parameters.parameter_names()) - set(same) <= changed
        if "v_pace" in changed:
            factor = kind.change(means).v_pace / means.v_pace
            assert now.v_pace == pytest.approx(was.v_pace * factor)


def test_the_kinds_of_the_issue_are_there():
    assert set(KINDS) == set(kinds.names())
    slow, fast, base = (resolve.resolve_humans(word).population.mean() for word in ("slow", "fast", "proxy"))
    assert kinds.load("slow").change(slow).v_pace < base.v_pace < kinds.load("fast").change(fast).v_pace


@given(
    st.sampled_from(parameters.parameter_names()),
    st.sampled_from(["add", "times", "set"]),
    st.floats(-1e5, 1e5),
    st.floats(0, 1),
)
def test_a_change_never_leaves_the_range(name: str, verb: Any, value: float, share: float):
    low, high = parameters.parameter_range(name)
    start = low + (min(high, 1e3) - low) * share
    change = kinds.ParameterEdit(parameter=name, verb=verb, value=value, reason="")
    assert parameters.range_problem(name, change.apply(start)) == ""


def test_a_kind_that_is_no_good_is_named_with_its_field(files: Path):
    path = files / "half.json"
    whole = json.loads(path.read_text())

    def refused(document: Any, *words: str) -> None:
        path.write_text(document if isinstance(document, str) else json.dumps(document))
        with pytest.raises(PopulationError) as caught:
            resolve.resolve_humans(str(path))
        for word in words:
            assert word in str(caught.value)

    def changed(**fields: Any) -> dict[str, Any]:
        return {**whole, "changes": [{**whole["changes"][0], **fields}]}

    refused("{", "half.json: $: is not JSON")
    refused({**whole, "schema": "other/1"}, "schema: is 'other/1'")
    refused({**whole, "name": "third"}, "name: it is 'third', but must be the file's name, 'half'")
    refused(changed(parameter="v_pase"), "changes[0].parameter", "Did you mean 'v_pace'?")
    refused(changed(verb="set", value=-1.0), "changes[0].value: -1 is out of range")
    refused(changed(verb="divide"), "changes[", "verb")
    refused({**whole, "extra": 1}, "extra")


# ------------------------------------------------------------------------------------- robots meet the same people


def test_every_robot_meets_the_same_people(files: Path):
    suite, word = fakes.suite(20), f"slow@{files}/pop.npz"
    crews = [
        fakes.crew("helper"),
        fakes.crew("other"),
        fakes.crew("helper", "other"),
        fakes.crew("none", absent=True),
    ]
    dealt = [sessions.make_sessions(suite, agent=crew, humans=word, seed=4) for crew in crews]
    stage = TrialRunner(Sources(humans=resolve.resolve_humans(word).word))
    met = []
    for run in dealt:
        whole = []
        for one in run:
            trial = one.trials[0]
            found = stage._people_of(trial).members[0]
            whole.append(
                (
                    one.number,
                    [t.task.id for t in one.trials],
                    found.participant(trial.seed, trial.humans[0].participant),
                )
            )
            assert (trial.humans[0].model, trial.humans[0].sha256) == (found.name, found.sha256)
        met.append(whole)
    assert met[0] == met[1] == met[2] == met[3]
    assert len({traits.traits.v_pace for _, _, traits in met[0]}) == len(met[0])


def test_a_participant_of_a_population_is_the_same_person_in_any_order():
    found = resolve.resolve_humans("proxy")
    ahead = [found.participant(1, k) for k in range(6)]
    assert [found.participant(1, k) for k in reversed(range(6))] == ahead[::-1]
    assert found.participant(2, 0) != found.participant(1, 0)
    who = found.participant(1, 3)
    assert who.root == participant.participant_root(1, 3)
    row = found.population.pick(1, 3)
    assert who.traits == participant.add_random_effects(
        found.population.parameters(row), who.root, found.population.specs
    )


def test_people_who_are_alike_are_the_mean():
    found = resolve.resolve_humans("greedy")
    assert found.participant(0, 1).traits == found.participant(5, 2).traits == found.population.mean()


def test_a_file_that_changes_during_a_run_stops_it(files: Path):
    found = resolve.resolve_humans(f"{files}/pop.npz")
    (one, *_) = sessions.make_sessions(
        fakes.suite(10), agent=fakes.crew("helper"), humans=human_team.form_team([found])
    )
    population_file.save_population(small(suite="other"), files / "pop")  # says something else of the same people
    assert TrialRunner(Sources(humans=found.word))._people_of(one.trials[0]).sha256 == found.sha256
    rows = [[0.4, 0.2]]
    population_file.save_population(
        Population.make("pop", rows, names=("v_pace", "sigma"), purpose="", seed=0, command=""), files / "pop"
    )
    with pytest.raises(HthorError, match=r"pop\.npz was changed while its run was going on"):
        TrialRunner(Sources(humans=found.word))._people_of(one.trials[0])


# ---------------------------------------------------------------------------------------------------------- validity


def refer(population: Population, count: int = 20, crew: Any = None) -> HumanModelRef:
    found = msgspec.structs.replace(
        resolve.resolve_humans("literature"), population=population, name="pop", word="/dir/pop.npz"
    )
    return human_populations.human_model_ref(
        human_team.form_team([found]), fakes.suite(count), crew or fakes.crew("helper")
    )


def test_people_are_valid_where_they_were_calibrated():
    ref = refer(small())
    assert (ref.valid, ref.notes, ref.name, ref.source, ref.population) == (True, (), "pop", "pop.npz", "pop")
    assert refer(small(), crew=fakes.crew("none", absent=True)).valid


def test_elsewhere_they_are_not_and_it_says_where():
    def noted(population: Population, *words: str, **where: Any) -> None:
        ref = refer(population, **where)
        assert not ref.valid
        assert len(ref.notes) == 1, ref.notes
        for word in words:
            assert word in ref.notes[0]

    noted(small(), "calibrated on the tasks of the suite fake, not on other tasks", count=10)
    noted(small(suite="paper", suite_sha256="ab" * 32), "the suite paper, not on those of the suite fake")
    noted(small(simulation=rules.SIMULATION + 1), f"version {rules.SIMULATION + 1} of the world")
    noted(
        small(mind=parameter_registry.PROXY_VERSION + 1),
        f"version {parameter_registry.PROXY_VERSION + 1} of the proxy's mind",
    )
    noted(small(rules_sha256="ab" * 32), "other constants of the benchmark")
    noted(small(settings={**human_populations.robot_settings("scout", "own"), "speed_m_s": 9.0}), "speed_m_s 9, not")
    noted(small(), "detector own, not noisy", crew=fakes.crew("helper", detector="noisy"))
    noted(msgspec.structs.replace(small(), missing=("wings",)), "made before there was wings")
    noted(resolve.resolve_humans("literature").population, "fitted to no data")


# -------------------------------------------------------------------------------------------------- several at a time


def test_words_for_several_peoples(files: Path):
    assert [one.name for one in human_populations.find_people(["kinds"])] == [resolve.default_population(), *KINDS]
    assert [one.name for one in human_populations.find_people(["bracket"])] == [
        "greedy",
        "random",
        resolve.default_population(),
    ]
    named = human_populations.find_people([f"kinds@{files}/pop.npz"])
    assert [one.name for one in named] == ["pop", *(f"{kind}@pop" for kind in KINDS)]
    assert {one.members[0].population.sha256 for one in named} == {small().sha256}
    assert [
        one.name for one in human_populations.find_people(["proxy", resolve.default_population(), "slow", "slow"])
    ] == [
        "proxy",
        "slow",
    ]
    (files / "sub").mkdir()
    population_file.save_population(
        Population.make("pop", [[0.5]], names=["v_pace"], purpose="", seed=0, command=""), files / "sub" / "pop"
    )
    with pytest.raises(HthorError, match="two different populations are called 'pop'"):
        human_populations.find_people([f"{files}/pop.npz", f"{files}/sub/pop.npz"])
    with pytest.raises(UnknownName, match="'kinds'"):
        human_populations.find_people(["kindz"])


@pytest.fixture
def fake(monkeypatch: pytest.MonkeyPatch) -> None:
    """A suite called ``fake`` of twenty tasks, played in no time."""
    real = tasks.load_suite
    monkeypatch.setattr(tasks, "load_suite", lambda name: fakes.suite(20) if name == "fake" else real(name))
    monkeypatch.setattr(session_runner, "make_runner", fakes.player)


@pytest.mark.usefixtures("fake")
def test_each_people_is_a_run_of_its_own(files: Path):
    words = (f"{files}/pop.npz", f"slow@{files}/pop.npz")
    options = EvalOptions(
        agent=("none", "frontier"), humans=words, suite="fake", jobs=1, out=files / "out", control=False
    )
    told: list[str] = []

    class Watcher(progress.Silent):
        def record(self, text: str) -> None:
            told.append(text)

    done = list(experiment.run_experiment(planning.resolve(options), lambda _: Watcher()))
    assert [(one.config.humans.name, one.config.name) for one in done] == [
        *(("pop", "none"), ("pop", "frontier"), ("slow@pop", "none"), ("slow@pop", "frontier")),
    ]
    assert [one.folder.path for one in done] == [
        files / "out" / one.config.humans.name / one.config.name for one in done
    ]
    assert all(one.result.humans.valid for one in done)
    assert told == []
    assert done[2].config.folder_name.startswith("none-fake-slow@pop-")
    assert done[0].result.hashes.human != done[2].result.hashes.human
    whole = population_matrix.make_matrix([one.result for one in done])
    assert whole.agents == ("none", "frontier")
    assert set(whole.cells) == {"pop", "slow@pop"}
    assert whole.cells["pop"]["frontier"].adoption.n > 0
    assert whole.conclusions == ()
    for agent, worst in whole.worst.items():
        rates = {name: cells[agent].sr.mean for name, cells in whole.cells.items()}
        assert worst.sr == min(rates.values())
        assert worst.peoples == tuple(name for name, rate in rates.items() if rate == worst.sr)
        assert worst.behind == rates["pop"] - worst.sr


@pytest.mark.usefixtures("fake")
def test_the_bracket_says_what_becomes_of_each_conclusion(files: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(session_runner, "make_runner", fakes.leaning_player)
    words, agents = (f"bracket@{files}/pop.npz", f"slow@{files}/pop.npz"), ("none", "frontier")
    options = EvalOptions(agent=agents, humans=words, suite="fake", jobs=1, out=files / "out", control=False)
    whole = population_matrix.make_matrix(
        [one.result for one in experiment.run_experiment(planning.resolve(options), lambda _: progress.Silent())]
    )
    assert [ref.name for ref in whole.peoples] == ["greedy@pop", "random@pop", "pop", "slow@pop"]
    assert {(one.better, one.worse, one.metric, one.verdict) for one in whole.conclusions} == {
        *(("frontier", "none", metric, "flips") for metric in ("sr", "twsr"))
    }
    for found in whole.conclusions:
        (middle, *ends) = found.gaps
        rates = {
            name: {agent: getattr(cell, found.metric).mean for agent, cell in row.items()}
            for name, row in whole.cells.items()
        }
        assert [gap.people for gap in ends] == ["greedy@pop", "random@pop"]
        for gap in found.gaps:
            assert gap.mean == pytest.approx(rates[gap.people][found.better] - rates[gap.people][found.worse])
        assert middle.mean > 0.0
        assert (found.verdict == "flips") == any(gap.mean < 0.0 for gap in ends)
    assert all(set(worst.peoples) <= {"pop", "slow@pop"} for worst in whole.worst.values())


@pytest.mark.usefixtures("fake")
def test_what_is_not_calibrated_is_told_once_and_kept(files: Path):
    population_file.save_population(small(suite="paper", suite_sha256="ab" * 32), files / "pop")
    told: list[str] = []

    class Watcher(progress.Silent):
        def record(self, text: str) -> None:
            told.append(text)

    options = EvalOptions(
        agent=("none", "frontier"), humans=(f"{files}/pop.npz",), suite="fake", jobs=1, out=files / "out", control=False
    )
    done = list(experiment.run_experiment(planning.resolve(options), lambda _: Watcher()))
    assert told == [], "it is said at the end"
    (said,) = result_tables.result_notes([one.result for one in done])
    assert said.startswith("note: the population pop was calibrated on the tasks of the suite paper, not on those of ")
    stored = json.loads((files / "out" / "frontier" / "result.json").read_bytes())
    assert stored["schema"] == result_file.SCHEMA
    assert stored["humans"]["valid"] is False
    assert [one in said for one in stored["humans"]["notes"]] == [True]
    assert stored["humans"]["population_sha256"] == small().sha256
    assert done[0].folder.config.humans == done[0].result.humans
    console = Console(record=True, width=150, file=io.StringIO())
    console.print(result_tables.result_table(done[0].result))
    console.print(result_tables.comparison_table([one.result for one in done]))
    assert "calibrated" not in console.export_text(), "once is enough"


def test_a_worker_finds_files_by_path(files: Path):
    """Real worker processes, started in another folder than the files lie in."""
    model = "from hthor.humans.models.proxy import Model as Proxy\nclass Model(Proxy): pass\n"
    (files / "mine.py").write_text('"""Mine."""\n' + model)
    suite = fakes.make_suite("one", 1, tasks.load_suite("smoke").tasks[:1])
    found = resolve.resolve_humans(f"{files}/mine.py@{files}/pop.npz")
    (one,) = sessions.make_sessions(suite, agent="none", humans=human_team.form_team([found]), participants=1)
    code = (
        "import sys, msgspec\nfrom hthor.trials import Sources, TrialRunner\n"
        "from hthor.types import TrialSpec\n"
        "trial = msgspec.json.decode(sys.stdin.buffer.read(), type=TrialSpec)\n"
        "found = TrialRunner(Sources(humans=sys.argv[1]))._people_of(trial).members[0]\n"
        "print(type(found.make_model(trial.seed, 0)).__module__, found.participant(0, 0).traits.v_pace)\n"
    )
    said = subprocess.run(
        [sys.executable, "-c", code, found.word],
        input=msgspec.json.encode(one.trials[0]),
        capture_output=True,
        cwd="/",
        check=False,
    )
    assert said.returncode == 0, said.stderr.decode()
    assert said.stdout.decode().split() == ["hthor.humans.models.mine", str(found.participant(0, 0).traits.v_pace)]


# ------------------------------------------------------------------------------------------------------ the terminal


@pytest.fixture
def hthor(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    """Run a command in this process."""
    monkeypatch.setenv("COLUMNS", "150")
    monkeypatch.delenv("FORCE_COLOR", raising=False)
    monkeypatch.setenv("_TYPER_FORCE_DISABLE_TERMINAL", "1")

    def run(*words: str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["hthor", *words])
        try:
            cli.main()
            code = 0
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else int(end.code is not None)
        return code, *capsys.readouterr()

    return run


def test_list_names_everybody(hthor):
    code, out, _ = hthor("humans", "list", "--json")
    rows = {row["name"]: row for row in json.loads(out)}
    assert code == 0
    assert set(rows) == set(resolve.human_names())
    assert {row["sort"] for row in rows.values()} == {"population", "kind", "model"}
    assert all(row["purpose"] for row in rows.values())
    assert rows["slow"]["sha256"] == resolve.resolve_humans("slow").sha256
    code, out, _ = hthor("humans", "list")
    for name in resolve.human_names():
        assert name in out


def test_describe_tells_every_parameter(hthor, files: Path):
    code, out, _ = hthor("humans", "describe", "literature", "--json")
    told = json.loads(out)
    assert code == 0
    assert [trait["name"] for trait in told["traits"]] == list(parameter_registry.free_parameter_names())
    for trait in told["traits"]:
        assert trait["says"] == "not identified"
        assert trait["quantiles"] == pytest.approx(trait["prior_quantiles"], rel=0.02, abs=0.02)
        assert trait["source"]
    code, out, _ = hthor("humans", "describe", "literature")
    assert out.count("not identified") == len(parameter_registry.free_parameter_names())
    for trait in told["traits"]:
        assert trait["name"] in out
    assert "fitted to no data" in out
    code, out, _ = hthor("humans", "describe", str(files / "pop.npz"))
    assert "valid for: suite fake" in out
    code, out, _ = hthor("humans", "describe", "slow", "--json")
    told = json.loads(out)
    change = next(change for change in told["changes"] if change["parameter"] == "v_pace")
    assert change["after"] == pytest.approx(change["before"] * change["value"])
    assert told["reason"] == kinds.load("slow").reason
    assert told["population"] == "study", "the word that commands take, not the name of a file"
    code, _, err = hthor("humans", "describe", "slwo")
    assert code == 2
    assert "Did you mean 'slow'?" in err


def test_sample_shows_whom_a_study_meets(hthor):
    code, out, _ = hthor("humans", "sample", "slow", "--n", "4", "--seed", "3", "--json")
    rows = json.loads(out)
    assert code == 0
    found = resolve.resolve_humans("slow")
    for number, row in enumerate(rows):
        assert row.pop("participant") == number
        assert Parameters(**row) == found.participant(3, number).traits
    code, out, _ = hthor("humans", "sample", "slow", "--n", "4", "--seed", "3")
    assert len([line for line in out.splitlines() if line.strip() and line.split()[0].isdigit()]) == 4
    assert all(name in out for name in describe.varying_parameters(found))


@pytest.mark.usefixtures("fake")
def test_eval_with_several_peoples_compares_them(hthor, files: Path):
    words = ("eval", "--agent", "none", "--agent", "frontier", "--suite", "fake", "--jobs", "1")
    names = ("pop", "slow@pop")
    whom = ("--humans", str(files / "pop.npz"), "--humans", f"slow@{files}/pop.npz", "--out", str(files / "out"))
    code, out, _ = hthor(*words, *whom, "--quiet")
    assert code == 0
    assert all(name in out for name in names)
    worst = [line for line in out.splitlines() if ": * worst with " in line or ": no people are worse off" in line]
    assert [line.split(":")[0] for line in worst] == ["no robot", "frontier"]
    code, out, _ = hthor(*words, *whom, "--quiet", "--json")  # the runs are there: only scored
    document = json.loads(out)
    assert document["schema"] == "hthor.eval/1"
    told = document["peoples"]
    assert told["schema"] == "hthor.peoples/2"
    assert [(ref["name"], ref["kind"]) for ref in told["peoples"]] == [("pop", ""), ("slow@pop", "slow")]
    results = [one["result"] for one in document["runs"]]
    assert [(one["humans"]["name"], one["name"]) for one in results] == [
        (name, agent) for name in names for agent in ("none", "frontier")
    ]
    assert set(told["worst"]) == {"none", "frontier"}
