"""Checks each point of an agent's contract by the results of its probe trials."""

import math
import statistics
from collections.abc import Sequence
from typing import Literal

from msgspec import Struct

from hthor import rules
from hthor.episode import Fault
from hthor.eval.agent_check.probe_trials import ProbeResult
from hthor.eval.runner.fault_report import redact
from hthor.guest import File
from hthor.humans.population.parameters import Parameters
from hthor.trials.robot_team import AgentInfo

Status = Literal["ok", "broken", "warning", "skipped"]
_ADVICE = {
    "raised": "The last lines say where it failed. Fix that, and check again.",
    "timeout": "A step may take 5 s, and 60 s more in all. Do less in act, or spread the work over several steps.",
    "died": "Its process ended. Look for os._exit, a crash in a library, or what it printed last.",
    "memory": "Load less, or load it in smaller parts.",
    "disk": "Write less, and delete files that are no longer needed; only the folder that TMPDIR names can be written.",
    "wrong_type": "Return hthor.types.Action(motion=..., say=...) from every path through act.",
    "garbage": "Give the fields of Action values of the types that docs/agents.md lists.",
    "oversized": "Shorten texts and ids: an action takes 64 KiB at most.",
    "not_finite": "Look for a division by zero, or a mean of an empty list, on the way to that number.",
}
_FILES = 8
_SLOW_LOAD_S, _SLOW_BEGIN_S, _LOUD = 5.0, 1.0, 15_000
_ON_ONE_SPOT = 0.5
"""Share of a trial that an agent may spend on one spot before it is warned; our choice."""
_A_FEW, _TAKES_S = 2, 2.0 * Parameters().t_read
"""Messages that an agent may send: so many, and one per this time [s], in which the median person reads and answers."""
_READING = "A person takes about 3 s to read a message, and each new one covers the one before."


class Finding(Struct, frozen=True, kw_only=True):
    """The result of one check, in words, and what to do next."""

    check: str
    status: Status
    told: str = ""
    advice: str = ""


def check_loading(seconds: float, character: AgentInfo) -> Finding:
    """The check "loads": how long the agent took to load, and which privileges it asks for."""
    asked = ", ".join(character.ref.privileges) or "no privileges"
    told = f"in {seconds:.2f} s; asks for {asked}"
    if seconds < _SLOW_LOAD_S:
        return Finding(check="loads", status="ok", told=told)
    advice = "60 s are allowed. Import less, or later; import libraries at the top of the file, where it is done once."
    return Finding(check="loads", status="warning", told=told, advice=advice)


def check_files(character: AgentInfo, later: Sequence[File] = ()) -> Finding:
    """The check "files": which files the agent consists of, and which it opened only ``later``, while it played."""
    held = character.manifest.files if character.manifest else ()
    names = [file.path for file in held]
    shown = ", ".join(names[:_FILES]) + (f" and {len(names) - _FILES} more" if len(names) > _FILES else "")
    size = sum(file.bytes for file in held)
    claim = ", as its server says" if character.manifest and character.manifest.claimed else ""
    told = f"{shown or 'none named'} ({size} bytes){claim}"
    if later:
        told += f"; only in play: {', '.join(file.path for file in later[:_FILES])}"
    return Finding(check="files", status="ok", told=told)


def check_trial(notes: ProbeResult, agent: str) -> list[Finding]:
    """The checks "begins" and "acts": whether the agent began, and acted until the trial's end."""
    if notes.faults:
        fault = notes.faults[0]
        began = bool(notes.asked or fault.tick)
        broken = _broken("acts" if began else "begins", fault, agent, len(notes.actions) + 1)
        return [Finding(check="begins", status="ok"), broken] if began else [broken]
    begins = Finding(check="begins", status="ok", told=f"in {notes.begin_s:.2f} s")
    if notes.begin_s > _SLOW_BEGIN_S:
        advice = "Every trial takes that. Import libraries at the top of the file; persistent = True keeps the process."
        begins = Finding(check="begins", status="warning", told=begins.told, advice=advice)
    return [begins, Finding(check="acts", status="ok", told=f"{len(notes.actions)} actions in a trial, all legal")]


def _broken(name: str, fault: Fault, agent: str, step: int) -> Finding:
    when = f"step {step}, after {fault.tick * rules.TICK_S:.1f} s" if name == "acts" else "in begin"
    detail = redact(fault.detail.strip(), [agent])
    return Finding(
        check=name, status="broken", told=f"{fault.kind}, {when}\n{detail}", advice=_ADVICE.get(fault.kind, "")
    )


VARIES = (
    "Draw random numbers from random.Random(0) or numpy.random.default_rng(0), made in begin; do not read the clock, "
    "and let no result depend on the timing of threads."
)
LEAKS = "Reset everything in begin: what a class, a module or a file keeps lasts into other trials."


def check_same(name: str, one: ProbeResult, other: ProbeResult, what: str, advice: str) -> Finding:
    """Whether two plays of one trial are equal; if not, the first step in which they differ."""
    if one.line == other.line and one.actions == other.actions:
        return Finding(check=name, status="ok", told=f"{what}: {len(one.actions)} actions and every byte the same")
    for step, (a, b) in enumerate(zip(one.actions, other.actions, strict=False), 1):
        if a != b:
            told = f"{what} differs at step {step} (tick {a[0]}): {a[1]} and {b[1]}"
            return Finding(check=name, status="broken", told=told, advice=advice)
    told = f"{what}: {len(one.actions)} actions and {len(other.actions)}"
    if other.faults:
        told += f"; the second time it failed: {other.faults[0].kind}"
    return Finding(check=name, status="broken", told=told, advice=advice)


def figures(notes: ProbeResult) -> dict[str, float]:
    """The time and the memory that the agent used in a trial, by name."""
    if not notes.thought_s:
        return {"begin_s": notes.begin_s}
    ordered = sorted(notes.thought_s)
    return {
        "begin_s": notes.begin_s,
        "step_ms_median": 1000.0 * statistics.median(ordered),
        "step_ms_p99": 1000.0 * ordered[math.ceil(0.99 * len(ordered)) - 1],
        "share": sum(ordered) / max(notes.lasted_s, rules.TICK_S),
        "memory_mb": notes.memory_mb,
    }


def check_speed(notes: ProbeResult) -> Finding:
    """The check "fast enough": whether the agent thought for less time than the trial lasted."""
    found = figures(notes)
    told = (
        f"median {found['step_ms_median']:.2f} ms a step, 99 % within {found['step_ms_p99']:.2f} ms, "
        f"{100.0 * found['share']:.1f} % of the trial's {notes.lasted_s:.0f} s"
    )
    if found["memory_mb"]:
        told += f"; {found['memory_mb']:.0f} MB"
    if found["share"] <= 1.0:
        return Finding(check="fast enough", status="ok", told=told)
    advice = "It thinks longer than the trial lasts: 'hthor eval --clock charged' would charge that."
    return Finding(check="fast enough", status="warning", told=told, advice=advice)


def warnings(trials: tuple[ProbeResult, ...], character: AgentInfo) -> list[Finding]:
    """Warnings about behaviour that the contract allows, but that is probably a mistake."""
    found: list[tuple[str, str]] = []
    if any(len(one.output) > _LOUD for one in trials):
        found.append(("it prints much", "Only the last 16 KiB are kept, and printing costs time."))
    found += _moving(trials)
    refused, motions = sum(one.refused for one in trials), sum(one.motions for one in trials)
    if motions and refused > motions / 2:
        why = "observation.outcome says why: blocked, out of reach ..."
        found.append((f"{refused} of {motions} motions failed", why))
    found += _speaking(trials)
    unseen, claims = sum(one.unseen for one in trials), sum(one.claims for one in trials)
    if unseen and "object_poses" not in character.ref.privileges:
        advice = "Claims are scored, and false ones cost trust: say what was detected."
        found.append((f"{unseen} of {claims} messages were about what it had not detected", advice))
    return [Finding(check="note", status="warning", told=told, advice=advice) for told, advice in found]


def _moving(trials: tuple[ProbeResult, ...]) -> list[tuple[str, str]]:
    """Warnings, with advice, for an agent whose robot stays where it is."""
    if not any(one.motions for one in trials):
        return [("it never moved", "Return Action(motion=Move(...)) or Rotate(...) when observation.idle.")]
    longest = max(trials, key=lambda one: one.spot_s)
    if longest.spot_s <= _ON_ONE_SPOT * longest.lasted_s:
        return []
    told = f"it stood on one spot for {longest.spot_s:.0f} of {longest.lasted_s:.0f} s"
    return [(told, "It can only report what it has seen: go on exploring, and look at observation.outcome.")]


def _speaking(trials: tuple[ProbeResult, ...]) -> list[tuple[str, str]]:
    """Warnings, with advice, for an agent that never speaks, or speaks more than a person can follow."""
    if not any(one.sent for one in trials):
        return [("it never sent a message", "Without Send(text, object, position) the person learns nothing from it.")]
    loudest = max(trials, key=lambda one: one.sent)
    if loudest.sent > _A_FEW + loudest.lasted_s / _TAKES_S:
        parts = ((loudest.covered, "covered by the next one"), (loudest.repeated, "the same as the one before"))
        counted = ", ".join(f"{count} {what}" for count, what in parts if count)
        told = f"it sent {loudest.sent} messages in {loudest.lasted_s:.0f} s" + (f": {counted}" if counted else "")
        return [(told, f"{_READING} Send what is new, once, and again only after observation.receipt says declined.")]
    return []
