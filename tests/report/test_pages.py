"""The report and the case study: what they refuse, what they claim, that they need nothing else and never vary."""

from __future__ import annotations

import itertools
import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import msgspec
import numpy as np
import pytest
from report_fakes import PUBLISHED, run
from typer.testing import CliRunner

from hthor import houses, jsonio
from hthor.cli import app as cli
from hthor.errors import HthorError, RunError, UnknownName
from hthor.eval.records import trial_record
from hthor.guest import Isolation
from hthor.report.analysis import build, load_runs, trial_selection
from hthor.report.analysis.document import Findings
from hthor.report.drawing import render_trial, text_fit
from hthor.report.html import matplotlib_svg
from hthor.report.page import camera_frames, case_study, figure_index, headline, key_moments, page, write_report
from hthor.report.page.figures import case_study as case_figure


@pytest.fixture(scope="module", autouse=True)
def _known_house() -> Iterator[None]:
    plan = houses.load("hazel")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(render_trial, "load_house", lambda *_: plan)
        yield


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    base = tmp_path_factory.mktemp("runs")
    return [run(base / "alone", "silent", absent=True), run(base / "helper", "helper"), run(base / "clumsy", "clumsy")]


@pytest.fixture(scope="module")
def written(folders: list[Path], tmp_path_factory: pytest.TempPathFactory) -> tuple[Findings, Path]:
    out = tmp_path_factory.mktemp("report")
    return write_report.write_report(folders, out, PUBLISHED), out


def _told(*folders: Path) -> tuple[Findings, str]:
    """What a report says of runs, and its page, without the drawings."""
    found = build.build_findings(load_runs.with_baselines(load_runs.load_runs(folders)))
    return found, page.render(found, {})


def _bytes(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def test_the_same_runs_give_the_same_bytes(written: tuple[Findings, Path], folders: list[Path], tmp_path: Path) -> None:
    write_report.write_report(folders, tmp_path / "again", PUBLISHED)
    first, again = _bytes(written[1]), _bytes(tmp_path / "again")
    assert first == again
    assert {"report.html", "report.json", "figures/scores.svg", "figures/time-spent.svg"} <= first.keys()
    for folder in (tmp_path, written[1]):
        assert str(folder).encode() not in b"".join(first.values())


def test_the_page_needs_nothing_else(written: tuple[Findings, Path]) -> None:
    text = (written[1] / "report.html").read_text()
    for stranger in ("http", "<script", "src=", "@import", "url(h", "xlink"):
        assert stranger not in text
    assert set(re.findall(r"var\(--(\w+)\)", text)) <= set(matplotlib_svg.VARIABLES.values())
    ids = re.findall(r' id="([^"]+)"', text)
    assert len(ids) == len(set(ids))
    assert set(re.findall(r"url\(#([^)]+)\)", text)) | set(re.findall(r'href="#([^"]+)"', text)) <= set(ids)


def test_every_figure_says_what_it_shows_and_stands_alone(written: tuple[Findings, Path]) -> None:
    text = (written[1] / "report.html").read_text()
    files = sorted((written[1] / "figures").glob("*.svg"))
    assert text.count("<svg ") == len(files) == len(re.findall(r'<svg role="img"[^>]*><title>[^<]+</title>', text))
    for path in files:
        root = ElementTree.fromstring(path.read_text())
        title = root.find("{http://www.w3.org/2000/svg}title")
        assert title is not None
        assert title.text
        assert "var(" not in path.read_text()
        assert re.findall(r'https?://[^"]*', path.read_text()) == ["http://www.w3.org/2000/svg"]


def test_the_numbers_are_those_of_the_trials(written: tuple[Findings, Path], folders: list[Path]) -> None:
    found = written[0]
    alone, helper, clumsy = load_runs.load_runs(folders)
    assert msgspec.json.decode((written[1] / "report.json").read_bytes(), type=Findings) == found
    assert [arm.label for arm in found.arms] == ["no robot", "helper", "clumsy"]
    assert [arm.condition for arm in found.arms] == ["none", "", ""]
    pairs = [(a.met, b.met) for a, b in zip(helper.records, alone.records, strict=True)]
    gain = found.uplift[0]
    assert (gain.first, gain.second, gain.n) == ("no robot", "helper", 20)
    assert gain.differences["sr"].difference == pytest.approx(sum(a - b for a, b in pairs) / 20)
    assert gain.mcnemar.only_second == sum(a > b for a, b in pairs)
    assert gain.mcnemar.only_first == sum(a < b for a, b in pairs)
    assert [(pair.first, pair.second) for pair in found.comparisons[2:]] == [("helper", "clumsy")]
    spent = found.spent[1]
    assert spent.solved[-1] == pytest.approx(1.0 - spent.unsolved / spent.trials)
    assert spent.solved[45] == pytest.approx(sum(one.met and one.ticks <= 450 for one in helper.records) / 20)
    failed = [one for one in clumsy.records if one.faults]
    assert [(one.run, one.kind, one.trials, one.whole) for one in found.failures] == [
        ("clumsy", "raised", len(failed), 20)
    ]
    shown = [one for one in found.shown if one.arm == "helper"]
    assert [one.rank for one in shown] == ["best", "best", "worst", "worst"]
    gains = [one.gain_s for one in shown]
    assert min(gains[:2]) >= max(gains[2:])
    assert len({one.key for one in shown}) == 4


def test_what_is_put_in_is_escaped_and_uncertain_gains_are_not_claimed(written: tuple[Findings, Path]) -> None:
    found = written[0]
    gain = msgspec.structs.replace(found.uplift[0], second="<b>", sentence="<b> said")
    for better, said in (
        ("", "these data cannot tell &lt;b&gt; from no robot"),
        ("<b>", "&lt;b&gt; is better than no"),
    ):
        arms = (found.arms[0], msgspec.structs.replace(found.arms[1], label="<b>"))
        pairs = (msgspec.structs.replace(gain, better=better),)
        text = page.render(msgspec.structs.replace(found, arms=arms, comparisons=pairs, apart=()), {})
        assert said in text
        assert "<b>" not in text
    many = msgspec.structs.replace(found, comparisons=found.comparisons * 3)
    assert headline.headline(many).endswith("Section 2 has all pairs.")
    nobody = msgspec.structs.replace(found, baseline="", arms=found.arms[1:], comparisons=())
    assert "no run without a robot" in headline.headline(nobody)


def test_runs_that_share_no_trial_are_told_apart_and_not_compared(folders: list[Path], tmp_path: Path) -> None:
    other = run(tmp_path / "other", "helper", seed=1)
    found, text = _told(*folders[:2], other)
    assert [(pair.first, pair.second) for pair in found.comparisons] == [("no robot", "helper (helper)")]
    assert {(one.first, one.second, one.field) for one in found.apart} == {
        ("no robot", "helper (other)", "seed"),
        ("helper (helper)", "helper (other)", "seed"),
    }
    assert "Helper (helper) and helper (other) are not compared trial by trial: their seeds differ" in text


def test_what_is_left_of_an_agent_is_shown_with_the_command_that_plays_it_again(
    folders: list[Path], tmp_path: Path
) -> None:
    mine = shutil.copytree(folders[2], tmp_path / "clumsy")
    first = trial_selection.fault_summary(load_runs.load_runs([mine])[0])[0]
    assert (first.detail.splitlines()[-1], first.output, first.again) == ("ValueError: no", "", "")
    told = {
        "seat": "robot",
        "kind": "raised",
        "detail": "Traceback\nKeyError: <i>",
        "output": "last & least",
        "looks": [],
    }
    left = {"schema": "hthor.faults/2", "key": first.key, "failures": [told], "again": f"hthor agent run x {first.key}"}
    jsonio.write(mine / "faults" / f"{first.key}.json", msgspec.json.encode(left))
    _, text = _told(mine)
    again = f"hthor agent run {mine} {first.key}"  # with the run's folder as it is reached from here
    for said in ("KeyError: &lt;i&gt;", "last &amp; least", again, first.replay):
        assert said in text
    jsonio.write(mine / "faults" / f"{first.key}.json", b"torn")
    assert trial_selection.fault_summary(load_runs.load_runs([mine])[0])[0] == first


def test_what_held_the_agents_and_where_they_were_played_is_told(folders: list[Path], tmp_path: Path) -> None:
    mine = shutil.copytree(folders[1], tmp_path / "mine")
    held = Isolation(level="L2", landlock_abi=7, seccomp=True, memory="4096 MB", reason_not_higher="no bubblewrap")
    jsonio.write(mine / "isolation.json", jsonio.pretty(held))
    there = {
        "system": "Linux",
        "machine": "x86_64",
        "cpu": "znver3",
        "simd": "AVX2",
        "libc": "glibc 2.36",
        "numpy": "2",
    }
    jsonio.write(mine / "platform.json", msgspec.json.encode([there]))
    found, text = _told(mine)
    own = next(one for one in found.origins if not one.beside)
    assert own.command == (
        f"hthor eval --agent helper.py --humans proxy --suite fake --robot scout --seed 0 --participants 2 --out {mine}"
    )
    assert "L2: Landlock (ABI 7), seccomp, memory 4096 MB. Not higher: no bubblewrap" in text
    assert "Linux, x86_64, znver3, AVX2, glibc 2.36" in text
    jsonio.write(mine / "platform.json", b"{")
    with pytest.raises(RunError, match=r"mine/platform\.json"):
        _told(mine)


def test_runs_that_do_not_belong_together_are_refused(folders: list[Path], tmp_path: Path) -> None:
    other = run(tmp_path / "other", "helper", count=30)
    with pytest.raises(RunError, match=r"other/run\.json: suite\.sha256 differs from .*alone/run\.json"):
        write_report.write_report([folders[0], other], tmp_path / "out")
    with pytest.raises(RunError, match="are the same run"):
        write_report.write_report([folders[1], folders[1]], tmp_path / "out")
    with pytest.raises(RunError, match=r"has no run\.json"):
        write_report.write_report([tmp_path], tmp_path / "out")
    assert not (tmp_path / "out").exists()
    with pytest.raises(HthorError, match="is a file"):
        write_report.write_report(folders, other / "run.json")


def test_a_damaged_run_is_refused_with_file_and_field(folders: list[Path], tmp_path: Path) -> None:
    broken = shutil.copytree(folders[1], tmp_path / "broken")
    lines = (broken / "trials.jsonl").read_bytes().replace(b'"met":true', b'"met":null', 1)
    (broken / "trials.jsonl").write_bytes(lines)
    with pytest.raises(RunError, match=r"broken/trials\.jsonl, line \d+: met"):
        write_report.write_report([broken], tmp_path / "out")
    other = shutil.copytree(folders[1], tmp_path / "foreign")
    (other / "trials.jsonl").write_bytes((folders[2] / "trials.jsonl").read_bytes())
    with pytest.raises(RunError, match=r"foreign/trials\.jsonl: trial \w+: spec\.robots is not the one in run\.json"):
        write_report.write_report([other], tmp_path / "out")


def test_a_report_of_one_run_takes_the_control_that_lies_beside(folders: list[Path], tmp_path: Path) -> None:
    mine = shutil.copytree(folders[1], tmp_path / "mine" / "helper")
    found = write_report.write_report([mine], tmp_path / "one")
    assert (found.baseline, found.uplift, found.by_people) == ("", (), None)
    assert all(one.gain_s is None for one in found.shown)
    assert not (tmp_path / "one" / "figures" / "compared.svg").exists()
    shutil.copytree(folders[0], mine / "control")
    found, _ = _told(mine)
    assert [(one.name, one.beside) for one in found.origins] == [("helper/control", True), ("helper", False)]
    assert [pair.second for pair in found.uplift] == ["helper"]
    lone, _ = _told(folders[0])
    assert (lone.shown, lone.trust, lone.comparisons) == ((), (), ())


def test_several_peoples_have_a_section_of_their_own(folders: list[Path], tmp_path: Path) -> None:
    others = [run(tmp_path / "a", "clumsy", people="slow"), run(tmp_path / "b", "silent", absent=True, people="slow")]
    found, _ = _told(*folders[:2], *others)
    assert found.by_people is not None
    assert [(group.name, sorted(group.sr)) for group in found.by_people.groups] == [
        ("proxy", ["helper", "no robot"]),
        ("slow", ["clumsy", "no robot"]),
    ]
    assert [arm.folder for arm in found.arms] == ["alone", "helper"]
    assert {people: [pair.second for pair in pairs] for people, pairs in found.people_uplift.items()} == {
        "proxy": ["helper"],
        "slow": ["clumsy"],
    }
    assert "people" in [one.name for one in figure_index.draw_figures(found, [])]


@pytest.mark.skipif(shutil.which("chromium") is None, reason="Chromium is not installed")
def test_a_browser_finds_no_error_and_asks_nobody(written: tuple[Findings, Path], tmp_path: Path) -> None:
    bad = tmp_path / "bad.html"
    bad.write_text('<script>nothing()</script><img src="http://example.invalid/a.png">')
    assert _browsed(bad, tmp_path) == (1, 1)  # so that it is known to be seen
    assert _browsed(written[1] / "report.html", tmp_path) == (0, 0)


def _browsed(file: Path, folder: Path) -> tuple[int, int]:
    """How many lines a page writes to the browser's console, and how many addresses it asks for."""
    log = folder / "net.json"
    options = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"]
    options += [f"--log-net-log={log}", "--enable-logging=stderr", f"--user-data-dir={folder / 'browser'}"]
    done = subprocess.run(
        ["chromium", *options, "--dump-dom", f"file://{file}"], capture_output=True, text=True, timeout=900, check=True
    )
    events = [event.get("params", {}) for event in msgspec.json.decode(log.read_bytes())["events"]]
    by_page = [one["url"] for one in events if one.get("initiator", "not an origin") != "not an origin"]  # not its own
    return done.stderr.count(":CONSOLE"), len({url for url in by_page if url.startswith("http")})


def test_moments_are_in_order_and_end_at_the_end(folders: list[Path]) -> None:
    house = houses.load("hazel")
    for one in load_runs.load_runs(folders):
        for held in one.records:
            found = key_moments.key_moments(held, house)
            ticks = [moment.tick for moment in found]
            assert len(ticks) == key_moments.MANY
            assert min(b - a for a, b in itertools.pairwise([0, *ticks])) >= 10
            assert ticks[-1] == held.ticks
            assert found[-1].words == ("done" if held.met else "time is up")
            said = [moment.tick for moment in found if moment.words == "robot, message 1"]
            assert said == ([40] if held.spec.robots else [])
            answered = [moment.tick for moment in found if moment.words == "person accepts"]
            assert answered == ([60] if held.metrics.adoption else [])


@pytest.fixture
def grey_views(monkeypatch: pytest.MonkeyPatch) -> None:
    """No trial is played again for its views."""

    def film(_: Path, wanted: trial_record.TrialRecord, ticks: list[int], **more: object) -> camera_frames.Seen:
        grey = np.full((24, 32, 3), 128, np.uint8)
        return camera_frames.Seen(views={tick: dict.fromkeys(wanted.paths, grey) for tick in ticks})

    monkeypatch.setattr(camera_frames, "render_frames", film)


def test_a_case_is_drawn_the_same_twice_and_says_who_can_be_drawn(
    folders: list[Path], tmp_path: Path, grey_views: None
) -> None:
    drawn = case_study.write_case_study(folders[:2], "t003", tmp_path / "case")
    root = ElementTree.fromstring(drawn[0].read_text())
    title = root.find("{http://www.w3.org/2000/svg}title")
    assert title is not None
    assert "no robot, helper" in (title.text or "")
    (alone,) = case_study.write_case_study(folders[:2], "t003", tmp_path / "case.svg")
    assert alone.name == "case.svg"
    assert alone.read_bytes() == drawn[0].read_bytes()
    with pytest.raises(HthorError, match=r"case.gif: the name of a picture must end in .png, .svg or .pdf\."):
        case_study.write_case_study(folders[:2], "t003", tmp_path / "case.gif")
    with pytest.raises(UnknownName, match=r"unknown task 't0003'\. Did you mean 't003'"):
        case_study.write_case_study(folders[:2], "t0003", tmp_path)
    with pytest.raises(UnknownName, match="unknown person '99'"):
        case_study.write_case_study(folders[:2], "t003", tmp_path, person=99)


@pytest.mark.nightly
@pytest.mark.parametrize("suffix", [".png", ".pdf"])
def test_a_case_in_one_file_is_the_same_twice(
    folders: list[Path], tmp_path: Path, grey_views: None, suffix: str
) -> None:
    one, two = (case_study.write_case_study(folders[:2], "t003", tmp_path / f"{name}{suffix}")[0] for name in "ab")
    assert one.name == f"a{suffix}"
    assert one.read_bytes() == two.read_bytes()


def test_the_words_above_a_case_are_whole() -> None:
    """A team's long name and what it said take several lines; only what no page has room for ends in an ellipsis."""
    team = "tender-oracle+puck-oracle: done in 67.9 s; message 1 of 3 (accepted): “I cannot open the fridge in front of"
    head = case_figure._lines(f"{team} me. Please look inside for the apple.”", 9.3, 8.5, bold=True)
    assert head.replace("\n", " ") == f"{team} me. Please look inside for the apple.”"
    assert head.count("\n") == 1
    endless = case_figure._lines("a name without end " * 99, 9.3, 8.5, bold=True)
    assert endless.count("\n") == 2
    assert endless.endswith("…")
    for line in (head + "\n" + endless).split("\n"):
        assert text_fit.text_width(line, 8.5, bold=True) < 9.3 - 0.3


def test_the_commands(folders: list[Path], tmp_path: Path) -> None:
    out = tmp_path / "cli"
    done = CliRunner().invoke(cli, ["report", *map(str, folders[:1]), "--out", str(out), "--pdf"])
    assert done.exit_code == 0, done.output
    assert done.stdout.strip() == str(out / "report.html")
    drawn = {suffix: {one.stem for one in (out / "figures").glob(f"*{suffix}")} for suffix in (".svg", ".pdf")}
    assert drawn[".svg"] == drawn[".pdf"] != set()
    assert "2406.06498" in (out / "report.html").read_text()
