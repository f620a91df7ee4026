"""What a simulated trial depends on, as hashes: stored trials of another world or person are never reused."""

from __future__ import annotations

import msgspec
from msgspec import Struct

from hthor import code_identity, installation, jsonio, plugins, rules
from hthor.calibration.simulation.trial_table import AGENTS
from hthor.humans.population.parameter_registry import PARAMETERS
from hthor.tasks import Suite

ROBOT = "scout"
"""The body of the article's robots."""
_T_STAR = "T_STAR"
_NOT_COURSE = ("t_star", "difficulty", "split")


class TrialIdentity(Struct, frozen=True, kw_only=True):
    """Hashes of everything that decides the course of trials of a suite; ``parts`` has them by name."""

    parts: dict[str, str]

    @property
    def sha256(self) -> str:
        """Hash of them all."""
        return jsonio.sha256(self.parts)

    def differences(self, other: TrialIdentity) -> list[str]:
        """Names of the parts that differ."""
        names = sorted({*self.parts, *other.parts})
        return [name for name in names if self.parts.get(name) != other.parts.get(name)]


def trials_identity(suite: Suite) -> TrialIdentity:
    """Hashes of everything that trials of this suite depend on, in this version of hthor and its libraries."""
    numbers = {name: value for name, value in rules.as_dict().items() if not name.startswith(_T_STAR)}
    priors = [(one.name, one.prior, one.effect, one.scale) for one in PARAMETERS]
    versions = {name: version for name, version in installation.versions().items() if name != "hthor"}
    return TrialIdentity(
        parts={
            f"suite {suite.name}": jsonio.sha256([_course(task) for task in suite.tasks]),
            "rules": jsonio.sha256(numbers),
            "parameters and their priors": jsonio.sha256(priors),
            **{f"version of {name}": version for name, version in versions.items()},
            "code": _code(suite),
        }
    )


def _course(task: object) -> dict[str, object]:
    """A task without the fields that do not affect its trials."""
    told: dict[str, object] = msgspec.to_builtins(task)
    return {name: value for name, value in told.items() if name not in _NOT_COURSE}


def _code(suite: Suite) -> str:
    """Hash of the code that plays sessions: the world, the proxy, the article's three robots, the suite's kinds."""
    own = [
        *(plugins.module_name("agent", name) for name in AGENTS),
        plugins.module_name("robot", ROBOT),
        *(plugins.module_name("task kind", kind) for kind in {task.kind for task in suite.tasks}),
    ]
    return code_identity.modules_sha256([*code_identity.roots("trial"), *code_identity.roots("sessions"), *own])


def statistics_sha256() -> str:
    """Hash of the code that turns tables of trials into populations."""
    return code_identity.modules_sha256(code_identity.roots("statistics"))
