"""Suites from a secret salt: made again from it alone, told by nothing before it is revealed, played like any other."""

from __future__ import annotations

import functools
import hashlib
import json
import os
import pickle
import stat
import sys
from pathlib import Path

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hthor import catalog, cli, houses, jsonio, tasks
from hthor.errors import HthorError, TaskError, UnknownName
from hthor.houses.checks.house_rules import error
from hthor.tasks.generation import secret_suites, standard
from hthor.tasks.generation.secret_suites import Proof, SuiteOrder
from hthor.tasks.suite import encode_suite, make_suite
from hthor.tasks.suites import commitment, library
from hthor.tasks.suites import commitment as salts
from hthor.tasks.suites.commitment import Salt
from hthor.tasks.validate import task_faults

TEXT = "5f1d0c9be7a84e2699c3b1d07a4418f2e35b6097cd12fa8870b94d6e1ac53f28"
SALT, OTHER = Salt(TEXT), Salt(TEXT[::-1])
ORDER = SuiteOrder(name="tiny", houses=2, tasks=4)
PURPOSES = st.lists(st.text(max_size=8) | st.integers(-(2**62), 2**62), max_size=4).map(tuple)


def soundly(house):
    return houses.check(house, 0.25, strict=True)


PROOF = Proof(house=soundly, task=lambda task, house: house.sha256 == task.house_sha256)


@pytest.fixture(scope="module")
def parts():
    """What comes of the two houses' lots, worked out once."""
    return [secret_suites.make_house_tasks(lot, PROOF) for lot in secret_suites.house_orders(ORDER, SALT)]


@pytest.fixture(scope="module")
def files(parts):
    return secret_suites.make_files(ORDER, SALT, PROOF, lambda work, lots: parts)


@pytest.fixture
def folder(files, tmp_path: Path) -> Path:
    secret_suites.write_suite(ORDER, SALT, tmp_path / "tiny", files, {"hthor": "1"})
    return tmp_path / "tiny"


_document = functools.cache(secret_suites._document)


@pytest.fixture
def documents(monkeypatch: pytest.MonkeyPatch):
    """A house is built once from its root, whoever judges it."""
    monkeypatch.setattr(secret_suites, "_document", _document)


def differences(folder: Path, parts, salt: Salt = SALT):
    held = commitment.load_commitment(folder / "commitment.json")
    return list(secret_suites.differences(folder, held, salt, PROOF, lambda work, lots: parts))


# --------------------------------------------------------------------------------------------------------- the salt


def test_a_fresh_salt_is_random_readable_by_its_owner_alone_and_never_written_over(tmp_path: Path):
    one, two = tmp_path / "deep" / "one", tmp_path / "two"
    before = os.umask(0)
    try:
        salts.create_salt(one)
        salts.create_salt(two)
    finally:
        os.umask(before)
    assert stat.S_IMODE(one.stat().st_mode) == 0o600
    assert not salts.is_exposed(one)
    assert salts.read_salt(one).commitment() != salts.read_salt(two).commitment()
    assert len(bytes.fromhex(one.read_text().strip())) == 32
    held = one.read_bytes()
    with pytest.raises(HthorError, match="never overwritten"):
        salts.create_salt(one)
    assert one.read_bytes() == held
    one.chmod(0o640)
    assert salts.is_exposed(one)


@pytest.mark.parametrize(
    ("data", "told"),
    [
        (TEXT[:31].encode(), "31 characters, at least 32"),
        (b"", "0 characters"),
        (b"a" * 64, "0 bits, at least 128"),
        (b"salt" * 16, "bits, at least 128"),
        (b"0123456789abcdefghijklmnopqrstuv" * 9, None),
        (f"{TEXT}\n{TEXT}".encode(), "the file has several"),
        ("ä".encode() * 40, "ASCII"),
        (None, "No such file"),
    ],
)
def test_salts_that_could_be_guessed_are_refused_and_not_repeated(data, told, tmp_path: Path):
    path = tmp_path / "salt"
    if data is not None:
        path.write_bytes(data)
    if told is None:
        salts.read_salt(path)
        return
    with pytest.raises(HthorError, match=told) as caught:
        salts.read_salt(path)
    assert "hthor suite salt" in str(caught.value)
    shown = str(caught.value).removeprefix(str(path))
    assert not data or data.decode(errors="ignore").strip()[:12] not in shown or not data.strip()


def test_white_space_around_a_salt_does_not_count(tmp_path: Path):
    (tmp_path / "a").write_text(TEXT)
    (tmp_path / "b").write_text(f"  {TEXT}\r\n")
    assert salts.read_salt(tmp_path / "a").reveal() == salts.read_salt(tmp_path / "b").reveal() == TEXT


def test_a_salt_is_shown_by_nothing_and_stays_in_its_process():
    assert TEXT not in f"{SALT} {SALT!r} {vars(type(SALT))}"
    with pytest.raises(TypeError, match="stays in the process"):
        pickle.dumps(SALT)


def test_the_commitment_is_a_hash_with_a_name_of_its_own():
    assert SALT.commitment() == hashlib.sha256(b"hthor.commitment/1\x00" + TEXT.encode()).hexdigest()
    assert SALT.commitment() != hashlib.sha256(TEXT.encode()).hexdigest()
    assert SALT.commitment() != OTHER.commitment()


@given(PURPOSES, PURPOSES)
def test_roots_and_words_are_of_their_purpose_alone(one, two):
    assert (SALT.root(*one) == SALT.root(*two)) == (one == two)
    assert (SALT.word(32, *one) == SALT.word(32, *two)) == (one == two)
    assert SALT.root(*one) != OTHER.root(*one)
    assert -(2**127) <= SALT.root(*one) < 2**127


@given(st.text(st.characters(min_codepoint=33, max_codepoint=126), min_size=1, max_size=80))
def test_a_text_never_seems_to_hold_more_than_its_letters_can(text):
    assert -1e-9 <= salts.estimate_bits(text) <= 6.6 * len(text)
    assert salts.estimate_bits(text * 40) <= 40 * salts.estimate_bits(text) + 8 * (len(text) + 40)


# -------------------------------------------------------------------------------------------------------- the suite


def test_the_same_salt_gives_the_same_bytes(parts):
    again = secret_suites.make_house_tasks(secret_suites.house_orders(ORDER, Salt(TEXT))[1], PROOF)
    assert again == parts[1]


def test_another_salt_or_another_name_gives_other_houses_and_tasks(parts):
    names = {lot.house for salt in (SALT, OTHER) for lot in secret_suites.house_orders(ORDER, salt)}
    names |= {lot.house for lot in secret_suites.house_orders(msgspec.structs.replace(ORDER, name="tiny2"), SALT)}
    assert len(names) == 6
    roots = [root for lot in secret_suites.house_orders(ORDER, SALT) for pair in lot.roots for root in pair]
    assert len(set(roots)) == len(roots)
    other = secret_suites.make_house_tasks(secret_suites.house_orders(ORDER, OTHER)[1], PROOF)
    assert other.file != parts[1].file
    assert json.loads(other.file)["rooms"] != json.loads(parts[1].file)["rooms"]
    assert {task.house_sha256 for task in other.tasks}.isdisjoint(task.house_sha256 for task in parts[1].tasks)


def test_its_tasks_are_sound_and_in_houses_of_its_own(files, folder: Path):
    suite = tasks.load_suite(folder)
    assert suite == tasks.load_suite(folder / "suite.json")
    assert len(suite.tasks) == 4
    assert len({task.house for task in suite.tasks}) == 2
    assert {task.split for task in suite.tasks} == {"new"}
    assert {task.difficulty for task in suite.tasks} <= {"easy", "medium", "hard"}
    assert {task.kind for task in suite.tasks} == {"object_goal_navigation", "mobile_manipulation"}
    known = {*houses.names(), *houses.names("unseen")}
    for task in suite.tasks:
        assert task.house not in known
        assert list(task_faults(task, suite.houses.load(task.house))) == []
        assert {thing.kind for thing in suite.houses.load(task.house).things} >= set(catalog.RECEPTACLES)
    assert library.house_files(folder) == {path[7:]: data for path, data in files.items() if path != "suite.json"}
    assert library.house_files("smoke") == {}


def test_nothing_that_is_written_tells_the_salt_or_a_root(folder: Path):
    roots = [root for lot in secret_suites.house_orders(ORDER, SALT) for pair in lot.roots for root in pair]
    secret = [TEXT, TEXT[:16], TEXT[-16:]]
    secret += [form for root in roots for form in (str(root), f"{root % 2**128:x}"[:16], str(root % 2**63))]
    written = b"".join(path.read_bytes() for path in sorted(folder.rglob("*.json"))).decode()
    assert [text for text in secret if text in written] == []
    for path in (folder / "houses").glob("*.json"):
        assert json.loads(path.read_bytes())["metadata"]["generator"] == {"version": 1}


def test_what_is_learned_of_public_suites_by_heart_finds_nothing_in_it(folder: Path):
    def marks(task):
        return task.instruction, task.robot_starts[0]

    public = [task for name in ("smoke", "paper", "standard") for task in tasks.load_suite(name).tasks]
    assert len({marks(task) for task in tasks.load_suite("standard").tasks}) == 2000, (
        "there a table would find everything"
    )
    assert {marks(task) for task in public}.isdisjoint(marks(task) for task in tasks.load_suite(folder).tasks)


def test_starts_lie_on_the_grid_so_that_no_digit_tells_how_they_were_drawn(folder: Path):
    for task in tasks.load_suite(folder).tasks:
        for pose in (task.human_start, *task.robot_starts):
            assert (round(pose.x, 4), round(pose.y, 4), round(pose.yaw, 4)) == (pose.x, pose.y, pose.yaw)


@pytest.mark.usefixtures("documents")
def test_a_house_that_is_unsound_or_too_small_is_drawn_again():
    lot = secret_suites.house_orders(SuiteOrder(name="tiny", houses=1, tasks=1), SALT)[0]
    seen = []

    def first_is_bad(house):
        seen.append(house.sha256)
        return (error("start-free", house.id, "bad"),) if len(seen) == 1 else ()

    made = secret_suites.make_house_tasks(lot, Proof(house=first_is_bad, task=PROOF.task))
    assert len(set(seen)) == 2
    assert made.tasks[0].house_sha256 == seen[1] == jsonio.sha256(json.loads(made.file))
    bad = msgspec.structs.replace(lot, roots=lot.roots[:1])
    with pytest.raises(
        HthorError, match=r"none of 1 roots gave a house of 4 rooms; the last failed: .*bad \(start-free\)"
    ):
        secret_suites.make_house_tasks(
            bad, Proof(house=lambda house: (error("start-free", house.id, "bad"),), task=PROOF.task)
        )


@pytest.mark.usefixtures("documents")
def test_a_task_that_cannot_be_done_is_drawn_again():
    lot = secret_suites.house_orders(SuiteOrder(name="tiny", houses=1, tasks=1), SALT)[0]
    seen = []

    def second(task, house):
        seen.append(task)
        return len(seen) == 2

    made = secret_suites.make_house_tasks(lot, Proof(house=lambda _: (), task=second))
    assert list(made.tasks) == seen[1:]
    assert seen[0] != seen[1]
    assert (seen[0].goal, seen[0].house_sha256) == (seen[1].goal, seen[1].house_sha256)


@pytest.mark.parametrize(
    ("name", "many", "count", "told"),
    [
        ("Big", 1, 1, "cannot be a suite's name"),
        ("a/b", 1, 1, "cannot be a suite's name"),
        ("", 1, 1, "cannot be a suite's name"),
        ("fine", 3, 2, "2 tasks in 3 houses"),
        ("fine", 0, 2, "2 tasks in 0 houses"),
    ],
)
def test_orders_that_cannot_be_met(name, many, count, told):
    with pytest.raises(HthorError, match=told):
        secret_suites.house_orders(SuiteOrder(name=name, houses=many, tasks=count), SALT)


@given(st.integers(1, 40), st.integers(0, 400))
def test_tasks_are_shared_out_evenly_and_a_quarter_are_searches(many, more):
    lots = secret_suites.house_orders(SuiteOrder(name="fine", houses=many, tasks=many + more), SALT)
    sums = [sum(count for _, count in lot.counts) for lot in lots]
    assert sum(sums) == many + more
    assert max(sums) - min(sums) <= 1
    for lot in lots:
        counts = dict(lot.counts)
        assert min(counts.values()) > 0
        searches, total = counts.get("object_goal_navigation", 0), sum(counts.values())
        assert abs(searches - secret_suites.SEARCHES * total) <= 0.5


# -------------------------------------------------------------------------------------------- commitment and reveal


def test_the_commitment_binds_every_file(folder: Path, files):
    held = commitment.load_commitment(folder / "commitment.json")
    assert held.files.keys() == files.keys()
    assert held.suite_sha256 == tasks.load_suite(folder).sha256
    assert list(commitment.find_changes(folder, held)) == []
    for path, data in files.items():
        for place in (0, len(data) // 2, len(data) - 1):
            (folder / path).write_bytes(data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :])
            assert list(commitment.find_changes(folder, held)) == [(path, "was changed after it was committed to")]
        (folder / path).unlink()
        assert list(commitment.find_changes(folder, held)) == [(path, "is missing")]
        (folder / path).write_bytes(data)
    (folder / "houses" / "more.json").write_bytes(b"{}")
    assert [path for path, _ in commitment.find_changes(folder, held)] == ["houses/more.json"]


def test_what_comes_of_the_salt_is_what_was_committed_to(folder: Path, parts):
    assert differences(folder, parts) == []
    [(path, problem)] = differences(folder, parts, OTHER)
    assert path == "commitment.json"
    assert "another salt" in problem
    assert TEXT not in problem


def test_a_suite_that_was_not_drawn_from_its_salt_is_found_out(folder: Path, parts):
    """Its maker picked the tasks by hand and committed to them: every hash fits, but they do not come of the salt."""
    suite = tasks.load_suite(folder)
    easier = msgspec.structs.replace(suite.tasks[0], t_star=suite.tasks[0].t_star / 2)
    forged = make_suite(suite.name, suite.version, (easier, *suite.tasks[1:]))
    names = [f"houses/{part.house}.json" for part in parts]
    files = {"suite.json": encode_suite(forged), **{name: (folder / name).read_bytes() for name in names}}
    secret_suites.write_suite(ORDER, SALT, folder, files, {})
    assert list(commitment.find_changes(folder, commitment.load_commitment(folder / "commitment.json"))) == []
    found = dict(differences(folder, parts))
    assert found.keys() == {"suite.json", "commitment.json"}
    assert "line 1 is the first" in found["suite.json"]  # the hash of all tasks stands there
    held = commitment.load_commitment(folder / "commitment.json")
    swapped = {**held.files, names[0]: held.files[names[1]], "houses/x.json": "0" * 64}
    jsonio.write(folder / "commitment.json", jsonio.pretty(msgspec.structs.replace(held, files=swapped)))
    assert {names[0], "houses/x.json"} <= dict(differences(folder, parts)).keys()


def test_only_the_right_salt_is_revealed(folder: Path):
    assert commitment.read_revealed_salt(folder) is None
    with pytest.raises(TaskError, match="salt of another suite"):
        commitment.reveal_salt(folder, OTHER)
    assert not (folder / "revealed.json").exists()
    assert commitment.reveal_salt(folder, SALT) == folder / "revealed.json"
    found = commitment.read_revealed_salt(folder)
    assert found is not None
    assert found.reveal() == TEXT


def test_damaged_records_name_the_field(folder: Path, tmp_path: Path):
    path = folder / "commitment.json"
    document = json.loads(path.read_bytes())
    for change, told in (({"houses": "two"}, "houses"), ({"date": "now"}, "date")):
        path.write_text(json.dumps({**document, **change}))
        with pytest.raises(TaskError, match=told):
            commitment.load_commitment(path)
    path.write_text("{")
    with pytest.raises(TaskError, match="not JSON"):
        commitment.load_commitment(path)
    with pytest.raises(TaskError, match="hthor suite make"):
        commitment.load_commitment(tmp_path / "none.json")
    (folder / "revealed.json").write_text(json.dumps({"schema": "hthor.revealed/1", "name": "tiny", "salt": "ä"}))
    with pytest.raises(TaskError, match="ASCII"):
        commitment.read_revealed_salt(folder)


# ------------------------------------------------------------------------------------------------- the command line


@pytest.fixture
def say(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]):
    """Run a command in this process: its exit code, what it wrote, and what it said."""
    monkeypatch.setenv("_TYPER_FORCE_DISABLE_TERMINAL", "1")
    monkeypatch.setenv("COLUMNS", "200")

    def run(*words: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["hthor", *map(str, words)])
        try:
            cli.main()
            code = 0
        except SystemExit as end:
            code = end.code if isinstance(end.code, int) else int(end.code is not None)
        return (code, *capfd.readouterr())

    return run


@pytest.mark.usefixtures("no_workers")
def test_a_season_from_salt_to_verdict(say, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Make, publish, play, draw, reveal, verify: and nothing tells the salt before it is revealed."""
    salt, folder, run = tmp_path / "salt", tmp_path / "season", tmp_path / "run"
    shown = []

    def done(*words: object) -> str:
        code, out, err = say(*words)
        assert code == 0, err
        shown.append(out + err)
        return out

    done("suite", "salt", "--out", salt)
    make = ("suite", "make", "season-1", "--salt-file", salt, "--houses", 1, "--tasks", 2, "--jobs", 1)
    made = json.loads(done(*make, "--out", folder, "--json"))
    assert made["commitment"]["tasks"] == 2
    assert json.loads(done("suite", "verify", folder, "--json"))["state"] == "sealed"
    done("eval", "--agent", "silent", "--suite", folder, "--out", run, "--jobs", 1, "--quiet")
    result = json.loads((run / "result.json").read_bytes())
    assert result["counts"]["trials"] == 2
    done("score", run)
    picture = tmp_path / "trial.png"
    done("replay", run, 0, "--out", picture)
    assert picture.stat().st_size > 10_000
    written = [path.read_bytes() for path in (*folder.rglob("*.json"), *run.rglob("*.json*"))]
    secret = salt.read_text().strip()
    assert not any(secret in text for text in shown)
    assert not any(secret.encode() in data for data in written)
    done("suite", "reveal", folder, "--salt-file", salt)
    assert "byte for byte" in done("suite", "verify", folder, "--jobs", 1)


def test_a_suite_that_was_tampered_with(say, folder: Path, tmp_path: Path):
    published = tmp_path / "published.json"
    published.write_bytes((folder / "commitment.json").read_bytes())
    forged = json.loads(published.read_bytes()) | {"salt": "0" * 64}
    (folder / "commitment.json").write_text(json.dumps(forged))
    (folder / "suite.json").write_bytes((folder / "suite.json").read_bytes() + b" ")
    code, out, err = say("suite", "verify", folder, "--commitment", published)
    assert code == 1
    assert "suite.json: was changed" in out
    assert "NOT the suite of the commitment (1 problem)" in out
    assert "it was made with hthor 1 (here" in err


def test_misuse_of_the_commands(say, folder: Path, tmp_path: Path):
    salt = tmp_path / "salt"
    salt.write_text(TEXT)
    salt.chmod(0o644)
    make = ("suite", "make", "tiny", "--houses", 1, "--tasks", 1, "--jobs", 1)
    code, _, err = say(*make, "--salt-file", salt, "--out", folder)
    assert code == 2
    assert "not empty" in err
    assert f"others can read {salt}" in err
    (folder / "salt").write_text(TEXT)
    code, _, err = say(*make, "--salt-file", folder / "salt", "--out", folder)
    assert code == 2
    assert "will be published; keep it elsewhere" in err
    code, _, err = say("suite", "make", "smoke", "--salt-file", salt, "--out", tmp_path / "new")
    assert code == 2
    assert "'smoke' is a suite of hthor's own" in err
    code, _, err = say("suite", "make", "tiny", "--houses", 1, "--tasks", 1)
    assert code == 2
    assert "--salt-file" in err
    (tmp_path / "other").write_text(TEXT[::-1])
    code, _, err = say("suite", "reveal", folder, "--salt-file", tmp_path / "other")
    assert code == 2
    assert "salt of another suite" in err
    code, _, err = say("suite", "verify", tmp_path / "nowhere")
    assert code == 2
    assert "commitment.json" in err


# ------------------------------------------------------------------------------------------------ houses of its own


def test_a_librarys_own_houses_are_found_by_name_after_ours(folder: Path):
    name = next((folder / "houses").glob("*.json")).stem
    library = houses.HouseLibrary(folder=folder / "houses")
    with pytest.raises(UnknownName):
        houses.load(name)
    assert library.load(name).id == name
    (folder / "houses" / "alder.json").write_bytes((folder / "houses" / f"{name}.json").read_bytes())
    assert library.load("alder") == houses.load("alder")
    with pytest.raises(UnknownName, match=name):
        library.load("h000")
    with pytest.raises(UnknownName):
        library.load("../houses/alder")
    assert name not in houses.names()


def test_a_suite_whose_houses_are_missing_says_so(folder: Path):
    for path in (folder / "houses").glob("*.json"):
        path.unlink()
    with pytest.raises(TaskError, match=r"tasks\[0\].house: unknown house"):
        tasks.load_suite(folder)
    with pytest.raises(TaskError, match="cannot be read"):
        tasks.load_suite(folder / "houses")


def test_tasks_alike_are_told_apart(parts):
    one = parts[0].tasks[0]
    step = msgspec.structs.replace(one.human_start, x=one.human_start.x + 0.8, y=one.human_start.y + 0.7)
    near = msgspec.structs.replace(one.human_start, x=one.human_start.x + 0.7)
    assert standard.are_alike(one, msgspec.structs.replace(one, human_start=near, id="other"))
    assert not standard.are_alike(one, msgspec.structs.replace(one, human_start=step))
    assert not standard.are_alike(one, msgspec.structs.replace(one, house="elsewhere"))
    assert not any(standard.are_alike(a, b) for part in parts for a in part.tasks for b in part.tasks if a.id != b.id)
