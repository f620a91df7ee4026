"""Dividing the sessions of a run among machines."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

from msgspec import Struct

from hthor.errors import HthorError

_T = TypeVar("_T")
_SHARD_ENDING = re.compile(r"-shard-\d+-of-\d+$")


class Shard(Struct, frozen=True, kw_only=True):
    """One share of a run: number ``number``, counted from 1, of ``of`` shares; it has ``trials`` trials."""

    number: int
    of: int
    trials: int = 0

    @property
    def words(self) -> str:
        """The shard as the command line names it, such as "3/16"."""
        return f"{self.number}/{self.of}"

    def share(self, whole: Sequence[_T]) -> tuple[_T, ...]:
        """This shard's part of the sessions: every ``of``-th, so that all shards have their share of every house."""
        return tuple(whole[self.number - 1 :: self.of])

    def folder(self, run: Path) -> Path:
        """The folder of this shard when the whole run's would be ``run``."""
        return run.with_name(f"{run.name}-shard-{self.number}-of-{self.of}")


def parse_shard(text: str) -> Shard:
    """The shard that the user named, such as "3/16"; raises HthorError when there is no such shard."""
    number, slash, of = text.partition("/")
    if not (slash and number.isdecimal() and of.isdecimal() and 1 <= int(number) <= int(of)):
        raise HthorError(f"--shard '{text}': expected i/N with i from 1 to N, such as 1/16 up to 16/16.")
    return Shard(number=int(number), of=int(of))


def whole_folder(folder: Path) -> Path:
    """The folder of the whole run, given the folder of a shard, which is named after it."""
    return folder.with_name(_SHARD_ENDING.sub("", folder.name))
