"""The tokens of a session's addresses: random, and kept until the session is over.

So a page that is open finds its seat again when the server was killed and started once more. They are in hthor's cache,
where only this user reads them, and not in the run's folder, which people share.
"""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from hthor import documents, installation, jsonio
from hthor.eval.config.options import EvalOptions


class SessionTokens:
    """The tokens of the session that a command with these options plays in this folder."""

    def __init__(self, options: EvalOptions) -> None:
        name = jsonio.sha256([repr(options), str(Path.cwd())])[:16]
        self._file = installation.cache() / "live" / "tokens" / f"{name}.json"

    def of(self, names: Iterable[str]) -> dict[str, str]:
        """The token of each of these places, such as "human"; made at the first time."""
        known: dict[str, str] = {}
        with suppress(FileNotFoundError, documents.Unreadable):  # a damaged file only costs open pages their addresses
            known = documents.decode(self._file.read_bytes(), dict[str, str])
        tokens = {name: known.get(name) or secrets.token_urlsafe(16) for name in names}
        if tokens != known:
            self._file.parent.mkdir(parents=True, exist_ok=True)
            beside = self._file.with_suffix(".new")
            beside.unlink(missing_ok=True)
            handle = os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
            with os.fdopen(handle, "wb") as file:
                file.write(jsonio.canonical(tokens))
            beside.replace(self._file)
        return tokens

    def forget(self) -> None:
        """The session is over."""
        self._file.unlink(missing_ok=True)
