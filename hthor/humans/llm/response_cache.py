"""A language model's answers, kept in a file so that nothing is asked twice.

One line of JSON per answer, append-only, safe for several processes at once. A run whose answers are all there needs no
model and gives the same bytes again; publish the file with the run.
"""

import fcntl
import os
from collections.abc import Callable
from pathlib import Path

import msgspec
from msgspec import Struct

from hthor import documents, jsonio


class CachedResponse(Struct, frozen=True, kw_only=True):
    """One answer: ``key`` hashes everything that it depends on."""

    key: str
    model: str
    temperature: float
    seed: int
    tokens: int
    prompt: str
    answer: str


_decoder = msgspec.json.Decoder(CachedResponse)


class ResponseCache:
    """The answers of one model to one person.

    Args:
        path: the file; created with the first answer.
        model: its name. temperature, seed, tokens: its settings, of which the keys are made too.
    """

    def __init__(self, path: Path, *, model: str, temperature: float, seed: int, tokens: int) -> None:
        self.path = path
        self._about = {"model": model, "temperature": temperature, "seed": seed, "tokens": tokens}
        self._known: dict[str, str] = {}
        self._read = 0

    def answer(self, prompt: str, ask: Callable[[str], str], most: int) -> str:
        """The answer to a question, from the file if it is there.

        Args:
            ask: asks the model; its answer is cut to ``most`` characters and kept.
        """
        key = jsonio.sha256({**self._about, "prompt": prompt})
        self._catch_up()
        if key not in self._known:
            self._keep(key, prompt, ask(prompt)[:most])
        return self._known[key]

    def _keep(self, key: str, prompt: str, answer: str) -> None:
        """Append an answer, unless another process was faster: the first one in the file counts."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        handle = os.open(self.path, os.O_RDWR | os.O_APPEND | os.O_CREAT | os.O_CLOEXEC, 0o644)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX)
            self._catch_up()
            if key not in self._known:
                end = os.fstat(handle).st_size
                torn = end > 0 and os.pread(handle, 1, end - 1) != b"\n"
                line = msgspec.json.encode(CachedResponse(key=key, prompt=prompt, answer=answer, **self._about))  # type: ignore[arg-type]
                os.write(handle, (b"\n" if torn else b"") + line + b"\n")
                self._catch_up()
        finally:
            os.close(handle)

    def _catch_up(self) -> None:
        """Read what was appended since; torn or damaged lines are skipped."""
        if not self.path.exists():
            return
        with self.path.open("rb") as file:
            file.seek(self._read)
            for line in file:
                if not line.endswith(b"\n"):
                    break
                self._read += len(line)
                try:
                    with documents.reading_errors():
                        asked = _decoder.decode(line)
                except documents.Unreadable:
                    continue
                self._known.setdefault(asked.key, asked.answer)
