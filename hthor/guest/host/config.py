"""How the submitted agents of a run are isolated and what they are given, as one record."""

from msgspec import Struct

from hthor.guest.agent.inputs import AgentInputs
from hthor.guest.confinement import AUTO, check_level


class GuestConfig(Struct, frozen=True, kw_only=True):
    """What holds for every guest of a run; it travels to the workers with everything else they need.

    Attributes:
        isolation: "L1", "L2", "L3", or "auto" for the strongest level that starts on this machine.
        hidden: files and folders that no agent may read, even in its own folder.
        inputs: constructor arguments, and files beyond the agent's own folder.
    """

    isolation: str = AUTO
    hidden: tuple[str, ...] = ()
    inputs: AgentInputs = AgentInputs()

    def __post_init__(self) -> None:
        """Check the level.

        Raises:
            UnknownName: when there is no such level.
        """
        check_level(self.isolation)
