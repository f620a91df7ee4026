"""Dividing a run among machines: the sessions of each shard, and its folder."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

from msgspec import Struct

from hthor.errors import HthorError

_T = TypeVar("_T")
_ENDING = re.compile(r"-shard-\d+-of-\d+$")


class Shard(Struct, frozen=True, kw_only=True):
    """One share of a run: the ``number``-th, counted from 1, ``of`` so many; it has ``trials`` trials."""

    number: int
    of: int
    trials: int = 0

    @property
    def words(self) -> str:
        """As the command line has it, such as "3/16"."""
        return f"{self.number}/{self.of}"

    def share(self, whole: Sequence[_T]) -> tuple[_T, ...]:
        """This shard's part of the sessions: every ``of``-th, so that all shards have their share of every house."""
        return tuple(whole[self.number - 1 :: self.of])

    def folder(self, run: Path) -> Path:
        """The folder of this shard when the whole run's would be ``run``."""
        return run.with_name(f"{run.name}-shard-{self.number}-of-{self.of}")


def parse_shard(text: str) -> Shard:
    """The shard that the user named, such as "3/16".

    Raises:
        HthorError: when the text cannot be parsed, or there is no such shard.
    """
    number, slash, of = text.partition("/")
    if not (slash and number.isdecimal() and of.isdecimal() and 1 <= int(number) <= int(of)):
        raise HthorError(f"--shard '{text}': expected i/N with i from 1 to N, such as 1/16 up to 16/16.")
    return Shard(number=int(number), of=int(of))


def whole_folder(folder: Path) -> Path:
    """The whole run's folder, after which a shard's folder was named."""
    return folder.with_name(_ENDING.sub("", folder.name))
