"""Where everything lies that a trial needs and hthor does not bring; workers get it as one record."""

from msgspec import Struct

from hthor.guest.agent.manifest import Manifest
from hthor.guest.host.config import GuestConfig


class Sources(Struct, frozen=True, kw_only=True):
    """Where the parts of a trial are that do not ship with hthor.

    Attributes:
        agent_paths: the submitted agents, by seat; ``manifests`` lists their files, by seat.
        robot_paths: the files of the user's own robots, by seat.
        kind_path: the file of a user's own task kind.
        assets: the name of the furniture pack that pictures show, empty for our own furniture.
        houses: the folder of the suite's own houses.
        humans: the word that finds the human population again; empty where the name in the trial does.
        guests: how submitted agents are isolated, and what they are given.
    """

    agent_paths: dict[str, str] = {}
    manifests: dict[str, Manifest] = {}
    robot_paths: dict[str, str] = {}
    kind_path: str = ""
    assets: str = ""
    houses: str = ""
    humans: str = ""
    guests: GuestConfig = GuestConfig()
