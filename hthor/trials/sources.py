"""Where the parts of a trial are that do not ship with hthor."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from msgspec import Struct

from hthor.guest.agent.manifest import Manifest
from hthor.guest.host.info import GuestConfig
from hthor.trials.robot_team import RobotTeam

if TYPE_CHECKING:
    from hthor.looks.pack import Pack


class Sources(Struct, frozen=True, kw_only=True):
    """The places of those parts of a trial that do not ship with hthor.

    Attributes:
        agent_paths: the submitted agents, by seat; ``manifests`` lists their files, by seat.
        robot_paths: the files of the user's own robots, by seat.
        kind_path: the file of a user's own task kind.
        assets: the name of the furniture pack that pictures show, empty for our own furniture.
        houses: the folder of the suite's own houses.
        humans: the word that finds the people again; empty where the names in the trial find them.
        guests: how submitted agents are isolated, and which arguments and files they get.
    """

    agent_paths: dict[str, str] = {}
    manifests: dict[str, Manifest] = {}
    robot_paths: dict[str, str] = {}
    kind_path: str = ""
    assets: str = ""
    houses: str = ""
    humans: str = ""
    guests: GuestConfig = GuestConfig()


def make_sources(
    team: RobotTeam,
    *,
    kind_path: str = "",
    assets: str = "",
    houses: Path | None = None,
    humans: str = "",
    guests: GuestConfig | None = None,
) -> Sources:
    """The sources of all that the trials of this team need; see `Sources`."""
    return Sources(
        agent_paths=team.agent_paths,
        manifests=team.manifests,
        robot_paths=team.robot_paths,
        kind_path=kind_path,
        assets=assets,
        houses=str(houses.resolve()) if houses is not None else "",
        humans=humans,
        guests=guests or GuestConfig(),
    )


def load_pack(assets: str) -> Pack | None:
    """The furniture pack of this name, None for our own furniture; raises UnknownName where no pack has it."""
    if not assets:
        return None
    from hthor.looks import pack

    return pack.load(assets)
