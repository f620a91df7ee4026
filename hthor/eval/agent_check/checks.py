"""Checks an agent against its contract in short real trials.

Each finding says what was wrong and what to do next. A "broken" point would cost the agent trials; a "warning" only
informs its author.
"""

import time

from msgspec import Struct

from hthor import code_identity, plugins
from hthor.errors import AgentError, HthorError
from hthor.eval.agent_check import criteria
from hthor.eval.agent_check.criteria import Finding
from hthor.eval.agent_check.probe_trials import ProbeTrials
from hthor.guest import AgentInputs, Guest, GuestConfig, Isolation
from hthor.guest.agent import agent_files
from hthor.trials import robot_team
from hthor.trials.robot_team import AgentInfo
from hthor.types.cameras import OWN

SCHEMA = "hthor.check/1"
CHECKS = ("loads", "files", "begins", "acts", "deterministic", "keeps nothing", "fast enough", "held")


class AgentCheckReport(Struct, frozen=True, kw_only=True):
    """The result of checking an agent. ``sound`` says that nothing is broken.

    ``figures``, as measured on this machine: seconds to load and to begin, milliseconds per step, the share of the
    trial's time that thinking took, and megabytes of memory.
    """

    schema: str = SCHEMA
    agent: str
    sound: bool
    findings: tuple[Finding, ...]
    privileges: tuple[str, ...] = ()
    persistent: bool = False
    isolation: Isolation | None = None
    figures: dict[str, float] = {}


def check_agent(
    agent: str, *, robot: str = "", camera: str = OWN, isolation: str = "auto", given: AgentInputs | None = None
) -> AgentCheckReport:
    """Check an agent's file, ``file.py`` or ``file.py:Class``.

    Args:
        robot: the body; by default the first that the agent is made for, or scout.
        camera: its camera, as `hthor.types.cameras.canonical_name` spells it.

    Raises:
        IsolationError: when this machine does not support the isolation level.
    """
    if agent in plugins.names("agent"):
        raise HthorError(f"'{agent}' ships with hthor; give an agent of your own, such as my_agent.py.")
    guests = GuestConfig(isolation=isolation, inputs=given or AgentInputs())
    code_identity.keep_compiled()
    try:
        character = robot_team.load_agent_info(agent, guests)
    except AgentError as error:
        broken = Finding(check="loads", status="broken", told=str(error), advice="Fix that, and check again.")
        return _report(agent, [broken], {})
    if character.absent:
        raise HthorError(f"{agent} says that there is no robot at all (absent = True), so there is nothing to check.")
    rehearsal = ProbeTrials(character, robot or (character.robots[0] if character.robots else "scout"), camera)
    with Guest(agent, config=guests) as guest:
        began = time.perf_counter()
        info = guest.load()
        load_s = time.perf_counter() - began
        (first,) = rehearsal.play(guest, [rehearsal.a])
        known = character.manifest
        opened = guest.take_opened()
        later = agent_files.unlisted_files(opened, known, guest.paths, guest.reference.path) if known else ()
    findings = [
        criteria.check_loading(load_s, character),
        criteria.check_files(character, later),
        *criteria.check_trial(first, agent),
    ]
    figures = {"load_s": load_s, **criteria.figures(first)}
    if not first.faults:
        with Guest(agent, config=guests) as guest:
            again, other, last = rehearsal.play(guest, [rehearsal.a, rehearsal.b, rehearsal.a])
        if not other.faults:  # only from the second trial on, begin imports the agent again
            findings[2], figures["begin_s"] = criteria.check_trial(other, agent)[0], other.begin_s
        findings += [
            criteria.check_same("deterministic", first, again, "the same trial twice", criteria.VARIES),
            *([criteria.check_trial(other, agent)[-1]] if other.faults else []),
            criteria.check_same(
                "keeps nothing", again, last, "the same trial before and after another one", criteria.LEAKS
            ),
            criteria.check_speed(first),
        ]
        findings += criteria.warnings((first, other), character)
    held = info.isolation
    words = held.level + (f"; not higher, as {held.reason_not_higher}" if held.reason_not_higher else "")
    findings.append(Finding(check="held", status="ok", told=words))
    return _report(agent, findings, figures, character, info.persistent, held)


def _report(
    agent: str,
    findings: list[Finding],
    figures: dict[str, float],
    character: AgentInfo | None = None,
    persistent: bool = False,
    held: Isolation | None = None,
) -> AgentCheckReport:
    """The report: findings in the order of `CHECKS`, "skipped" for checks that were not reached; warnings last."""
    found = {one.check for one in findings}
    skipped = [Finding(check=name, status="skipped") for name in CHECKS if name not in found]
    order = {name: place for place, name in enumerate(CHECKS)}
    return AgentCheckReport(
        agent=agent,
        sound=all(one.status != "broken" for one in findings),
        findings=tuple(sorted([*findings, *skipped], key=lambda one: order.get(one.check, len(order)))),
        privileges=character.ref.privileges if character else (),
        persistent=persistent,
        isolation=held,
        figures={name: round(value, 3) for name, value in figures.items()},
    )
