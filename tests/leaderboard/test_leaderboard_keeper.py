# ruff: noqa: F811  fixtures are imported, and named by tests
"""What the keeper of a board decides: who is ranked, what was verified or refuted, and what is taken at all."""

from __future__ import annotations

import json
from pathlib import Path

import msgspec
import numpy as np
import pytest
from board_fakes import COUNT, board, code, committed, contents, entry_of, kept, replayed, runs, verified, whole  # noqa: F401
from hypothesis import given, settings
from hypothesis import strategies as st
from law_cases import cases

from benchmarks import forging
from hthor import jsonio
from hthor.eval.runner.messages import SessionAbandoned
from hthor.leaderboard import board_check, enter, publish
from hthor.leaderboard.entries import column_packing, entry_metrics, files, trial_outcomes, verification
from hthor.leaderboard.entries.entry import Entry
from hthor.leaderboard.entries.files import BoardError
from hthor.leaderboard.entries.verification import KeeperRecords, Verification
from hthor.leaderboard.ranking import admission, listing
from hthor.leaderboard.ranking.board import Row
from hthor.leaderboard.verify import detection_power, fresh_tasks, performance_drop, replay, verdict, verify
from hthor.trials import sessions


def entries_of(board: Path) -> list[Entry]:
    return [files.read_entry(path) for path in files.entry_paths(board)]


def rows(entries: list[Entry], held: KeeperRecords, taken: admission.Admission | None) -> dict[str, Row]:
    return {row.name: row for section in listing.make_board(entries, held, taken).sections for row in section.rows}


# ------------------------------------------------------------------------------------------------------ who is ranked


def _records(found: Verification) -> KeeperRecords:
    return KeeperRecords(verifications={found.id: found}, refutations=())


def test_only_verified_entries_on_secret_tasks_have_a_rank(whole: Path):
    entries, taken = entries_of(whole), admission.load_admission(whole)
    (helper,) = [one for one in entries if one.agent.name == "helper"]
    ranked = rows(entries, kept(*entries), taken)
    assert ranked["helper"].ranks is not None
    assert ranked["helper"].unranked == ""
    assert ranked["no robot"].unranked == "reference"
    public = msgspec.structs.replace(
        taken, suites=tuple(msgspec.structs.replace(one, standing="development") for one in taken.suites)
    )
    for held, lists, why in (
        (kept(*entries), public, "public tasks"),
        (kept(*entries), None, "public tasks"),
        (verification.NO_RECORDS, taken, "not verified"),
        (_records(verified(helper, entry="1" * 64)), taken, "not verified"),
        (_records(verified(helper, control=replayed(caught=0.94))), taken, "too few draws"),
    ):
        row = rows(entries, held, lists)["helper"]
        assert (row.ranks, row.unranked) == (None, why)
    sections = listing.make_board(entries, kept(*entries), public).sections
    assert [one.standing for one in sections] == ["development"]


def test_an_agent_that_fell_on_fresh_tasks_has_no_rank_and_the_board_shows_both_figures(whole: Path):
    entries, taken = entries_of(whole), admission.load_admission(whole)
    (helper,) = [one for one in entries if one.agent.name == "helper"]
    owners = [number // 10 for number in range(200)]
    chance = np.random.default_rng(1).random(200)
    for share, fell in ((0.05, True), (float(helper.metrics.sr.mean or 0.0), False)):
        values = {"sr": (chance < share).astype(float), "twsr": 0.5 * (chance < share)}
        found = fresh_tasks.judge_fresh_tasks(helper, "0" * 64, values, owners)
        assert found.fell == fell
        assert found.claimed_sr == helper.metrics.sr.mean
        assert found.sr.mean == pytest.approx(values["sr"].mean())
        held = KeeperRecords(verifications={helper.id: verified(helper, fresh=found)}, refutations=())
        row = rows(entries, held, taken)["helper"]
        assert row.unranked == ("fell on fresh tasks" if fell else "")
        assert row.verification is not None
        assert row.verification.fresh == found


def test_clones_do_not_move_the_ranks_of_others(whole: Path):
    """Forty copies of an agent under other names, with a comment in their code, by other teams."""
    entries, taken = entries_of(whole), admission.load_admission(whole)
    (better,) = [one for one in entries if one.agent.name == "helper"]
    control = next(one for one in entries if one.alone)
    best = forging.forged(better, 1.0, control)
    crowd = [best_named(best, "best", number) for number in range(40)]
    before = rows([control, better, crowd[0]], kept(control, better, crowd[0]), taken)
    after = rows([control, better, *crowd], kept(control, better, *crowd), taken)
    assert before["helper"].ranks is not None
    assert before["helper"].ranks.sr.rank == 2
    assert before["helper"].ranks == after["helper"].ranks
    assert sum(row.ranks is not None for row in after.values() if row.name.startswith("best")) == 1
    assert {row.same_as for row in after.values() if row.name.startswith("best") and row.ranks is None} == {crowd[0].id}


def best_named(entry: Entry, name: str, number: int) -> Entry:
    robot = entry.run.robots[0]
    own = msgspec.structs.replace(robot, agent=msgspec.structs.replace(robot.agent, sha256=f"{number:064x}"))
    return msgspec.structs.replace(
        entry,
        id=f"{name}-{number:02d}-0123456789",
        agent=msgspec.structs.replace(entry.agent, name=f"{name}{number or ''}", team=f"team {number}"),
        run=msgspec.structs.replace(entry.run, robots=(own,)),
    )


def test_what_one_agent_is(whole: Path):
    helper, clumsy = (next(one for one in entries_of(whole) if one.agent.name == name) for name in ("helper", "clumsy"))
    held = {one.id: trial_outcomes.unpack(one.trials) for one in (helper, clumsy)}
    late = msgspec.structs.replace(held[helper.id], time=held[helper.id].time + 500)
    other = best_named(helper, "other", 1)
    apart = msgspec.structs.replace(clumsy, run=best_named(clumsy, "clumsy", 2).run)
    assert len(listing.group_duplicates([helper, other], [held[helper.id]] * 2)) == 1, "the same outcomes"
    assert len(listing.group_duplicates([helper, other], [held[helper.id], late])) == 2
    named = msgspec.structs.replace(other, agent=helper.agent)
    assert len(listing.group_duplicates([helper, named], [held[helper.id], late])) == 1, "a version, by name and team"
    same = msgspec.structs.replace(other, run=helper.run)
    assert len(listing.group_duplicates([helper, same], [held[helper.id], late])) == 1, "the same code"
    assert listing.similarity(held[helper.id], held[helper.id]) == 1.0
    assert len(listing.group_duplicates([helper, apart], [held[helper.id], late])) == 2


# ------------------------------------------------------------------------------------------------- the keeper's files


def test_a_refuted_entry_does_not_stand_and_nothing_brings_it_back(board: Path, runs: Path):
    path = entry_of(board, "helper")
    entry = files.read_entry(path)
    written = verification.write_verification(
        board, entry, verified(entry, trials=replayed(passed=False, why="not so."))
    )
    assert [one.parent.name for one in written] == ["verifications", "refutations"]
    publish.build_board(board)
    assert publish.differences(board) == []
    list_ = json.loads((board / "leaderboard.json").read_bytes())
    assert "helper" not in [row["name"] for section in list_["sections"] for row in section["rows"]]
    assert [one["id"] for one in list_["refuted"]] == [entry.id]
    assert "not so." in (board / "index.html").read_text()
    written[0].unlink()  # cut the verification out
    assert verification.load_records(board).refutation_of(entry) is not None
    path.unlink()  # and the entry, and hand it in again
    with pytest.raises(BoardError, match=r"was refuted on this board.*not so"):
        enter.add_runs(runs / "helper", board)
    renamed = msgspec.structs.replace(entry, agent=msgspec.structs.replace(entry.agent, name="someone else"))
    moved = msgspec.structs.replace(renamed, run=msgspec.structs.replace(entry.run, code_sha256="0" * 64))
    assert verification.load_records(board).refutation_of(moved) is not None, (
        "the same outcomes under another name and code"
    )
    control = next(one for one in entries_of(board) if one.alone)
    again = forging.forged(entry, 0.1, control)
    assert again.hashes.merkle != entry.hashes.merkle
    assert verification.load_records(board).refutation_of(again) is not None, "the same run with other outcomes"
    files.write_document(board / "verifications" / f"{again.id}.json", verified(again))
    assert verification.load_records(board).refutation_of(again) is None, "until its keeper has verified it"
    assert verification.load_records(board).refutation_of(entry) is not None


def test_a_refuted_control_takes_the_uplift_from_whoever_is_measured_against_it(board: Path):
    entry, control = (files.read_entry(entry_of(board, name)) for name in ("helper", "silent"))
    verification.write_verification(board, entry, verified(entry, control=replayed(passed=False, why="made worse.")))
    kept_ = verification.load_records(board)
    assert kept_.refutation_of(control) is not None
    assert kept_.refutation_of(entry) is None
    entries = [files.read_entry(path) for path in files.entry_paths(board)]
    row = rows(entries, kept_, admission.load_admission(board))["helper"]
    assert (row.ranks, row.uplift) == (None, None)
    assert row.unranked == "refuted, or its control was"
    publish.build_board(board)


def test_a_verification_is_of_one_entry_and_is_called_after_it(board: Path):
    entry, other = (files.read_entry(entry_of(board, name)) for name in ("helper", "clumsy"))
    with pytest.raises(BoardError, match="this verification is of"):
        verification.write_verification(board, entry, verified(other))
    files.write_document(board / "verifications" / f"{other.id}.json", verified(entry))
    with pytest.raises(BoardError, match="must be the file's name"):
        publish.build_board(board)


def test_no_genuine_entry_is_written_over(board: Path, runs: Path, tmp_path: Path):
    """Neither the agent's nor the control's, which others are measured against."""
    before = contents(board)
    enter.add_runs(runs / "helper", board)
    assert contents(board) == before, "the same once more is nothing new"
    for name in ("helper", "silent"):
        path = entry_of(board, name)
        true = path.read_bytes()
        entry = files.read_entry(path)
        files.write_document(
            path, forging.forged(entry, 0.3, files.read_entry(entry_of(board, "silent")) if name == "helper" else None)
        )
        other = contents(board)
        with pytest.raises(BoardError, match=r"has another entry of this run, and it is not overwritten"):
            enter.add_runs(runs / "helper", board)
        assert contents(board) == other
        path.write_bytes(true)


@pytest.mark.parametrize("what", ["people", "seed", "suite"])
def test_a_board_takes_only_what_its_keeper_listed(whole: Path, runs: Path, tmp_path: Path, what: str):
    lists = admission.load_admission(committed(tmp_path / "board"))
    narrow = {
        "people": {"people": (admission.Admitted(name="proxy", sha256="0" * 64),)},
        "seed": {"seeds": (3,)},
        "suite": {"suites": tuple(one for one in lists.suites if one.name != "fake")},
    }[what]
    files.write_document(tmp_path / "board" / admission.NAME, msgspec.structs.replace(lists, **narrow))
    told = {"people": r"people that this board does not take, 'proxy'", "seed": "run.seed", "suite": "run.suite.sha256"}
    with pytest.raises(BoardError, match=told[what]):
        enter.add_runs(runs, tmp_path / "board")
    assert not list((tmp_path / "board" / "entries").glob("*"))
    written = contents(whole)
    files.write_document(tmp_path / "lists.json", msgspec.structs.replace(lists, **narrow))
    for path in files.entry_paths(whole):
        found = list(admission.admission_problems(files.read_entry(path), admission.load_admission(tmp_path / "board")))
        assert len(found) == 1
    assert contents(whole) == written


def test_a_board_without_lists_takes_the_benchmark(tmp_path: Path):
    own = admission.load_admission(tmp_path)
    assert own.seeds == (0,)
    assert {one.name for one in own.people} == {"proxy"}
    assert {one.standing for one in own.suites} == {"development"}
    assert {"smoke", "standard"} <= {one.name for one in own.suites}


# ------------------------------------------------------------------------------------------------------- what is drawn


class Losing:
    """An engine that loses the sessions of one person, as where an agent's process is killed again and again."""

    def run_sessions(self, sessions, make):
        yield SessionAbandoned(session=1, cause="its process was killed by SIGKILL", detail="")


def test_a_verification_needs_every_trial_that_was_drawn(whole: Path, monkeypatch: pytest.MonkeyPatch):
    entry = files.read_entry(entry_of(whole, "helper"))
    trial = sessions.Session(number=1, trials=())
    wanted = [msgspec.structs.replace(trial, trials=(None,) * 4)]  # type: ignore[arg-type]
    monkeypatch.setattr(replay.engines, "find_engine", lambda *_, **__: Losing())
    with pytest.raises(BoardError, match=r"4 of the 4 trials.*could not be played \(session 1: its process was killed"):
        replay.run_sessions(entry, wanted, None, None)  # type: ignore[arg-type]


def test_there_is_no_verdict_over_a_part_of_a_draw():
    held = forging.made_up(count=60)
    nothing = verdict.ReplayedTrials(rows={}, met={}, twsr={})
    for tier in ("V1", "V2", "V3"):
        with pytest.raises(ValueError, match="1 drawn trials were not played"):
            verdict.judge_trials(tier, held, nothing, [5], [0] * 60)


def again_of(held: trial_outcomes.Outcomes, places) -> verdict.ReplayedTrials:
    return verdict.ReplayedTrials(
        rows={place: held.rows[place] for place in places},
        met={place: bool(held.met[place]) for place in places},
        twsr={place: int(held.twsr[place]) for place in places},
    )


def test_how_surely_three_false_outcomes_in_sixty_are_caught():
    """What a verification says of its own power is what the forger meets."""
    small, whose = forging.made_up(count=60), entry_metrics.trial_participants(60, 6)
    every = range(60)
    assert detection_power.detection_probability("V1", small, again_of(small, every), every, whose) == 1.0
    assert detection_power.detection_probability("V2", small, again_of(small, every), every, whose) == 1.0
    assert detection_power.detection_probability("V3", small, again_of(small, every), every, whose) < 0.5, (
        "not enough for a rank"
    )
    part = range(0, 60, 3)
    some = detection_power.detection_probability("V1", small, again_of(small, part), part, whose)
    assert some == pytest.approx(forging.caught("V1", 0.05, 300, sample=20, count=60) / 300, abs=0.09)
    assert some < verification.MIN_DETECTION
    large, owners = forging.made_up(), entry_metrics.trial_participants(2000, 200)
    drawn = range(0, 2000, 10)
    assert detection_power.detection_probability("V1", large, again_of(large, drawn), drawn, owners) > 0.999
    assert detection_power.detection_probability("V2", large, again_of(large, drawn), drawn, owners) > 0.95


def test_an_agent_that_does_not_repeat_itself_is_judged_by_all_its_trials():
    """One honest run in fifty is refused, and of a forged one hardly any stands where all trials are played."""
    assert forging.caught("V3", 0.05, 12, sample=2000, noise=0.2) == 12
    assert forging.caught("V3", 0.0, 12, sample=2000, noise=0.2) <= 1


def test_a_platform_that_was_not_noted_lowers_no_bar(board: Path):
    path = entry_of(board, "helper")
    request = replay.Request(word="chance", suite="nowhere")
    assert files.read_entry(path).platforms == ()
    with pytest.raises(BoardError, match="platforms: is empty"):
        verify.verify_entry(path, board, request)


def test_an_agent_that_does_not_repeat_itself_has_all_trials_drawn(whole: Path):
    entry = files.read_entry(entry_of(whole, "helper"))
    free = msgspec.structs.replace(entry, agent=msgspec.structs.replace(entry.agent, deterministic=False))
    assert verify._size(free, replay.Request(word="x")) == COUNT
    assert verify._size(entry, replay.Request(word="x")) == verify.SAMPLE
    assert verify.entry_tier(free) == "V3"


# ----------------------------------------------------------------------------------------- what follows from the tasks


def test_labels_times_and_what_they_are_worth_are_those_of_the_tasks(whole: Path):
    import eval_fakes as fakes

    entry = files.read_entry(entry_of(whole, "helper"))
    tasks = trial_outcomes.tasks_of_trials(fakes.suite(COUNT), entry)
    held = trial_outcomes.unpack(entry.trials)
    from hthor.leaderboard.entries import invariants

    assert list(invariants.check_outcomes(entry, held, tasks)) == []
    one = int(np.flatnonzero(held.met)[0])
    lost = int(np.flatnonzero(~held.met)[0])

    def fields(**changed) -> set[str]:
        return {field for field, _ in invariants.check_outcomes(entry, msgspec.structs.replace(held, **changed), tasks)}

    def put(column: np.ndarray, place: int, value: int) -> np.ndarray:
        fresh = column.copy()
        fresh[place] = value
        return fresh

    names, codes = held.labels["kind"]
    turned = {**held.labels, "kind": (names, put(codes, 0, 1 - int(codes[0])))}
    assert fields(labels=turned) == {"trials.labels.kind"}
    assert fields(labels={**held.labels, "split": (("seen",), codes * 0)}) == {"trials.labels.split"}
    assert fields(twsr=put(held.twsr, one, 1)) == {"trials.twsr"}
    assert fields(twsr=put(held.twsr, lost, 10**6)) == {"trials.twsr"}, "not met, and worth everything"
    assert fields(time=put(held.time, lost, 5)) == {"trials.time"}
    assert "trials.time" in fields(time=put(held.time, one, 60000))
    assert fields(useful=held.accepted + 1) == {"trials.useful"}
    assert "trials.adopted" in fields(adopted=~held.adopted)


def test_without_the_suite_failure_is_still_worth_nothing(board: Path):
    path = entry_of(board, "helper")
    document = json.loads(path.read_bytes())
    document["trials"]["twsr"] = column_packing.pack_numbers(np.full(COUNT, 10**6), 3)
    path.write_bytes(jsonio.pretty(document))
    assert "trials.twsr" in {one.field for one in board_check.check_board(board)}


# --------------------------------------------------------------------------------------------------------- fresh tasks


def test_a_fall_is_seen_as_often_as_is_said_and_an_honest_agent_is_not_flagged():
    chance = np.random.default_rng(3)
    claimed, whose = (chance.random(2000) < 0.89).astype(float), entry_metrics.trial_participants(2000, 200)
    seen = performance_drop.detectable_drop(claimed, whose, 200)
    assert seen is not None
    assert 0.04 < seen < 0.2
    assert performance_drop.detection_rate(claimed, whose, 200, seen) >= 0.8
    assert performance_drop.detection_rate(claimed, whose, 200, 0.0) <= 0.02
    memorised = (chance.random(200) < 0.58).astype(float)
    assert performance_drop.measure_drop(claimed, whose, memorised, [number // 10 for number in range(200)]).seen
    assert performance_drop.detectable_drop(np.zeros(60), entry_metrics.trial_participants(60, 6), 60) is None


@settings(max_examples=cases(25))
@given(st.integers(0, 200), st.integers(0, 60))
def test_the_better_it_went_the_less_of_a_fall(won: int, more: int):
    claimed = np.r_[np.ones(150), np.zeros(50)]
    owners = [number // 10 for number in range(200)]

    def p(count: int) -> float:
        return performance_drop.measure_drop(
            claimed, owners, np.r_[np.ones(count), np.zeros(260 - count)], [n // 10 for n in range(260)]
        ).p

    assert p(won) <= p(won + more) + 1e-9


def test_fresh_tasks_are_of_the_recipe_and_of_no_other_draw():
    from hthor import tasks
    from hthor.tasks.generation import fresh_tasks

    made = fresh_tasks.make_fresh_suite("smoke", 7, 3, lambda drafts: [True] * len(drafts))
    known = {(task.house, task.human_start) for task in tasks.load_suite("smoke").tasks}
    assert len(made.tasks) == 3
    assert not known & {(task.house, task.human_start) for task in made.tasks}
    assert fresh_tasks.make_fresh_suite("smoke", 7, 3, lambda drafts: [True] * len(drafts)) == made
    assert {task.kind for task in made.tasks} <= {task.kind for task in tasks.load_suite("smoke").tasks}
    refused: list[str] = []

    def possible(drafts):
        refused.extend(task.house for task in drafts if len(refused) < 1)
        return [task.house not in refused[:1] or len(drafts) == 1 for task in drafts]

    assert len(fresh_tasks.make_fresh_suite("smoke", 7, 2, possible).tasks) == 2, "what cannot be done is drawn again"
