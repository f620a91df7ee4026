"""Dividing a run among machines: which sessions are whose, and what the folder is called."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

from msgspec import Struct

from hthor.errors import HthorError

_Any = TypeVar("_Any")
_ENDING = re.compile(r"-shard-\d+-of-\d+$")


class Shard(Struct, frozen=True, kw_only=True):
    """One share of a run: the ``number``-th, counted from 1, ``of`` so many; it has ``trials`` trials."""

    number: int
    of: int
    trials: int = 0

    @property
    def words(self) -> str:
        """As the command line spells it."""
        return f"{self.number}/{self.of}"

    def share(self, whole: Sequence[_Any]) -> tuple[_Any, ...]:
        """What of the sessions is this shard's: every ``of``-th, so that all have their share of every house."""
        return tuple(whole[self.number - 1 :: self.of])

    def folder(self, run: Path) -> Path:
        """Where this shard of a run is written when the whole would be written to ``run``."""
        return run.with_name(f"{run.name}-shard-{self.number}-of-{self.of}")


def parse_shard(text: str) -> Shard:
    """The shard that the user named, such as "3/16".

    Raises:
        HthorError: when it cannot be read, or there is no such shard.
    """
    number, slash, of = text.partition("/")
    if not (slash and number.isdecimal() and of.isdecimal() and 1 <= int(number) <= int(of)):
        raise HthorError(f"--shard '{text}': expected i/N with i from 1 to N, such as 1/16 up to 16/16.")
    return Shard(number=int(number), of=int(of))


def whole_folder(folder: Path) -> Path:
    """The folder of the whole run that a shard's folder was named after."""
    return folder.with_name(_ENDING.sub("", folder.name))
