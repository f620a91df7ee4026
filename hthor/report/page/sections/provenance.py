"""Where the runs come from: everything that decides their records, how agents were isolated, and commands."""

from collections.abc import Callable, Mapping, Sequence

from hthor.eval.config.cli_command import BUILT_IN_AGENTS
from hthor.guest import Isolation
from hthor.report.analysis.document import Findings
from hthor.report.analysis.run_provenance import Platform, Provenance
from hthor.report.html import elements
from hthor.report.html.elements import Code, Piece
from hthor.report.terminal import corrections


def parts(found: Findings, _: Mapping[str, str]) -> list[str]:
    """The parts of the section."""
    said = (
        "Hashes by their first twelve digits; report.json has them whole. Equal hashes, seeds and platforms give the "
    )
    rows = [[title, *(value(one) for one in found.origins)] for title, value in _FIELDS.items()]
    beside = [one.name for one in found.origins if one.beside]
    return [
        elements.table(
            ("", *(one.name for one in found.origins)), rows, f"{said}same bytes.", words=range(len(found.origins) + 1)
        ),
        elements.paragraph(
            f"{', '.join(beside)} was not named, but found next to the others as the run without a robot."
        )
        if beside
        else "",
        *_corrections(found),
        elements.paragraph(f"The commands that play these runs again{_own(found)}:"),
        elements.block("\n".join(one.command for one in found.origins)),
    ]


def _corrections(found: Findings) -> list[str]:
    """The corrections of all runs, if there are any."""
    rows = [
        (
            one.name,
            str(each.correction.number),
            f"{each.task}, session {each.session}, trial {each.index + 1}",
            corrections.correction_words(each.correction),
            each.correction.reason,
            ", ".join(part for part in (each.correction.by, each.correction.date) if part),
        )
        for one in found.origins
        for each in one.corrections
    ]
    if not rows:
        return []
    said = "Corrections: what people found out about trials afterwards. All numbers follow them; logs do not change."
    return [elements.table(("run", "no.", "trial", "correction", "reason", "by"), rows, said, words=range(6))]


def _own(found: Findings) -> str:
    """Where the user's own files must be found: a run keeps their names and hashes, not their folders."""
    ours = all(robot.agent.source.startswith(BUILT_IN_AGENTS) for one in found.origins for robot in one.robots)
    return "" if ours else ", typed where the agents' files lie"


def _robots(one: Provenance) -> str:
    return "; ".join(f"{robot.robot} with {robot.agent.name}" if robot.robot else "no robot" for robot in one.robots)


def _agents(one: Provenance) -> Piece:
    return Code(" ".join(dict.fromkeys(robot.agent.sha256[:12] for robot in one.robots)))


def isolation(held: Isolation | None) -> str:
    """An isolation level in words, with its layers."""
    if held is None:
        return "built-in agents, inside"
    layers = {
        f"Landlock (ABI {held.landlock_abi})": held.landlock_abi > 0,
        "seccomp": held.seccomp,
        "no network": held.netns,
        "no other processes in sight": held.pidns,
    }
    named = [name for name, there in layers.items() if there] or ["a process with limits"]
    named += [f"memory {held.memory}"] if held.memory else []
    why = f". Not higher: {held.reason_not_higher}" if held.reason_not_higher else ""
    return f"{held.level}: {', '.join(named)}{why}"


def _platforms(held: Sequence[Platform]) -> str:
    words = (", ".join(part for part in (one.system, one.machine, one.cpu, one.simd, one.libc) if part) for one in held)
    return "; ".join(dict.fromkeys(words)) or "not noted"


def _suite(one: Provenance) -> str:
    kind = f", only {one.kind.name}" if one.kind is not None else ""
    return f"{one.suite.name}, version {one.suite.version}{kind}"


def _trials(one: Provenance) -> str:
    whole = str(one.trials) if one.trials == one.whole else f"{one.trials} of {one.whole}, not finished"
    attempts = "attempt does" if one.voided == 1 else "attempts do"
    voided = f"; {one.voided} voided {attempts} not count" if one.voided else ""
    return f"{whole}; {one.faulty} with a fault{voided}"


def _people(one: Provenance) -> str:
    drawn = f" out of the population {one.humans.population}" if one.humans.population else ""
    each = len(one.humans.members)
    together = f", {each} in each trial" if each > 1 else ""
    group = f"; a group of a study: {one.design.study}" if one.design else ""
    return f"{one.participants} {one.humans.name}{drawn}, model {one.humans.model}{together}{group}"


def _versions(one: Provenance) -> str:
    first = sorted(one.versions, key=lambda name: name != "hthor")
    return ", ".join(f"{name} {one.versions[name]}" for name in first)


_FIELDS: dict[str, Callable[[Provenance], Piece]] = {
    "robots": _robots,
    "suite": _suite,
    "people": _people,
    "seed": lambda one: str(one.seed),
    "trials": _trials,
    "thinking": lambda one: "takes no time (lockstep)" if one.mode == "lockstep" else f"takes time ({one.mode})",
    "isolation": lambda one: isolation(one.isolation) if any(robot.seat for robot in one.robots) else "no agent",
    "platform": lambda one: _platforms(one.platforms),
    "versions": _versions,
    "configuration": lambda one: Code(one.run_sha256[:12]),
    "agents": _agents,
    "humans": lambda one: Code(one.humans.sha256[:12]),
    "tasks": lambda one: Code(one.suite.sha256[:12]),
    "rules": lambda one: Code(one.rules_sha256[:12]),
    "code of the trials": lambda one: Code(one.code_sha256[:12]),
    "scoring": lambda one: Code(one.scoring_sha256[:12]),
    "furniture": lambda one: f"{one.assets.name} {one.assets.sha256[:12]}",
    "log": lambda one: Code(one.trials_sha256[:12]),
}
