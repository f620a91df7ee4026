"""What every event of a log has."""

from msgspec import Struct


class LogEntry(Struct, frozen=True, kw_only=True, tag_field="kind", omit_defaults=True):
    """One event of a trial's log: what a ``seat`` did, or what happened to it, at a ``tick``.

    In JSON it is one flat object that begins with its ``kind``. A field that has its default value is left out.

    Attributes:
        tick: ticks of `rules.TICK_S` since the trial began.
        seat: whose event it is; the first person's for events of the trial as a whole.
    """

    tick: int
    seat: str

    @property
    def kind(self) -> str:
        """The event's name in the log, such as "sent"."""
        return str(self.__struct_config__.tag)
