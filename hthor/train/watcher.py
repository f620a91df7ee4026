"""What a training reports as it goes."""

from __future__ import annotations

from typing import Any


class Watcher:
    """Is told how a training goes; this one does nothing with it."""

    def building(self, done: int, total: int) -> None:
        """So many grids are there."""

    def walking(self, done: int, total: int) -> None:
        """So many robots have been through all episodes."""

    def drawing(self, done: int, total: int) -> None:
        """The pictures of so many houses are there."""

    def training(self, frames: int, total: int) -> None:
        """So many actions were trained on."""

    def validated(self, row: dict[str, Any]) -> None:
        """A row of `metrics.jsonl`."""

    def seeing(self, pictures: int, total: int) -> None:
        """So many pictures were trained on."""

    def recognised(self, row: dict[str, Any]) -> None:
        """A row of `metrics.jsonl` of an encoder."""
