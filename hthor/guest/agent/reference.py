"""Finds the submitted agent that a user names, without importing or starting it.

Every command that takes an agent parses it here, so that all accept the same forms.
"""

import difflib
import hashlib
import os
import re
import shlex
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path
from urllib.parse import urlsplit

from msgspec import Struct

from hthor import plugins
from hthor.errors import AgentError, UnknownName
from hthor.guest.agent import manifest

FORMS = ("my_agent.py", "my_agent.py:Class", "package.module:Class", "cmd:PROGRAM ARGS", "ws://HOST:PORT[/PATH]")
"""The ways to name an agent that is not built in."""
CHECKPOINT = "checkpoint"
"""The argument of a built-in agent that a path behind its name stands for: ``savn:runs/savn/best``."""
SOCKET = "socket"
"""The word for a program that connects to a live session; ``socket:NAME`` tells several apart."""
HINT = f"An agent of your own is {', '.join(FORMS)} or wss://...; see docs/agents.md."
_MODULE = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*:[A-Za-z_]\w*")
_SOCKET = re.compile(rf"{SOCKET}(:([A-Za-z0-9_-]{{1,40}}))?")
_COMMANDS = ("cmd", "command", "exec", "run", "program", "process", "shell")
_SYSTEM = ("/usr", "/bin", "/sbin", "/lib", "/lib64", sys.prefix, sys.base_prefix)
_ENV = ("/usr/bin/env", "/bin/env")


class AgentReference(Struct, frozen=True, kw_only=True):
    """A submitted agent, as described before any of its code runs.

    Attributes:
        form: file, module, command, served, or socket for a program that connects to this process.
        text: a text that names the same agent for any process of this machine, in any working folder.
        source: its name in results, without folders of this machine.
        name: its name, unless the agent itself gives another name.
        path: the file that is imported or started; empty for an agent that runs elsewhere.
        root: its own folder, which it may read; empty if it has none.
        cls: the class to use, empty for the only one. module: the module's name if it is imported by name.
        words: the program and its arguments. url: the server's address.
        args: arguments of the constructor that the text itself gives.
    """

    form: str
    text: str
    source: str
    name: str
    path: str = ""
    root: str = ""
    cls: str = ""
    module: str = ""
    words: tuple[str, ...] = ()
    url: str = ""
    args: dict[str, str] = {}

    @property
    def built_in(self) -> bool:
        """Whether it is a built-in agent, which runs as a submitted agent because of its arguments."""
        return plugins.is_built_in("agent", self.source.partition(":")[0])

    @property
    def elsewhere(self) -> bool:
        """Whether it runs where hthor neither starts nor confines it, so that its identity is what it claims."""
        return self.form in ("served", SOCKET)

    @property
    def sha256(self) -> str:
        """Hash of its file; of a command's words without folders, and its files or else its program; "" if elsewhere.

        Raises:
            AgentError: when a file cannot be read.
        """
        if not self.words:
            return manifest.file_sha256(Path(self.path)) if self.path else ""
        own = own_files(self.words) or [Path(self.words[0])]
        parts = [*map(_bare, self.words), *map(manifest.file_sha256, own)]
        return hashlib.sha256("\0".join(parts).encode()).hexdigest()


def is_served(text: str) -> bool:
    """Whether this text names an agent that runs elsewhere: at an address, or as a program that connects."""
    return "://" in text or is_socket(text)


def is_socket(text: str) -> bool:
    """Whether this text stands for a program that connects to a live session."""
    return _SOCKET.fullmatch(text) is not None


def parse_reference(text: str, cls: str | None = None) -> AgentReference:
    """Parse the text by which a user names an agent.

    Raises:
        UnknownName: when the text has none of the `FORMS`.
        AgentError: when the module, program or address that it names does not exist.
    """
    if text.startswith("cmd:"):
        return _command(text)
    if "://" in text:
        return _served(text)
    if found := _SOCKET.fullmatch(text):
        return AgentReference(form=SOCKET, text=text, source=text, name=found[2] or SOCKET)
    file, colon, named = text.rpartition(":") if ".py:" in text else (text, "", "")
    if file.endswith(".py"):
        return _file(Path(file), cls or named, colon)
    name, colon, own = text.partition(":")
    if colon and plugins.is_built_in("agent", name):
        return _with_own_files(plugins.plugin_name("agent", name), own)
    if _MODULE.fullmatch(text):
        return _module(text)
    raise UnknownName("agent", text, plugins.names("agent"), _guess(text) + HINT)


def _file(file: Path, cls: str, colon: str) -> AgentReference:
    try:
        path = file.resolve()
    except RuntimeError:
        raise AgentError(f"cannot read the agent's file {file}: its link leads back to itself.") from None
    tail = f":{cls}" if colon or cls else ""
    return AgentReference(
        form="file",
        text=f"{path}{tail}",
        source=f"{file.name}{tail}",
        name=path.stem + tail,
        path=str(path),
        root=str(path.parent),
        cls=cls,
    )


def _with_own_files(name: str, path: str) -> AgentReference:
    """A built-in agent with the user's own checkpoint, a file or a folder; it runs as submitted agents do.

    Without a path it is the built-in agent with arguments that come from elsewhere.
    """
    place = Path(os.path.realpath(path)) if path else None
    if place is not None and not place.exists():
        raise AgentError(f"agent '{name}:{path}': there is no file or folder '{path}'. Write {name}:CHECKPOINT.")
    file = plugins.file("agent", name)
    return AgentReference(
        form="file",
        text=f"{name}:{place or ''}",
        source=f"{name}:{place.name if place else ''}",
        name=f"{name}-{place.stem}" if place else name,
        path=str(file),
        root=str(file.parent),
        cls="Agent",
        args={CHECKPOINT: str(place)} if place else {},
    )


def _module(text: str) -> AgentReference:
    module, _, cls = text.partition(":")
    for root in dict.fromkeys([Path.cwd(), *(Path(place).absolute() for place in sys.path if place)]):
        base = root.joinpath(*module.split("."))
        for path in (base / "__init__.py", base.parent / f"{base.name}.py"):
            if path.is_file():
                return AgentReference(
                    form="module",
                    text=text,
                    source=text,
                    name=text,
                    path=str(path.resolve()),
                    root=str(root),
                    cls=cls,
                    module=module,
                )
    where = "in this folder or among the installed ones"
    raise AgentError(f"agent '{text}': there is no module '{module}' {where}. {_guess(text)}{HINT}")


def _command(text: str) -> AgentReference:
    words = _parse_command(text.removeprefix("cmd:"))
    own = own_files(words)
    return AgentReference(
        form="command",
        text="cmd:" + shlex.join(words),
        source="cmd:" + shlex.join(map(_bare, words)),
        name=(own[0] if own else Path(words[0])).stem,
        path=words[0],
        root=str(own[0].parent) if own else "",
        words=words,
    )


def _served(text: str) -> AgentReference:
    parts = urlsplit(text)
    try:
        port = parts.port
    except ValueError:
        port = None
    if parts.scheme not in ("ws", "wss") or not parts.hostname or not port:
        raise UnknownName("agent", text, plugins.names("agent"), _guess(text) + HINT)
    if parts.username or parts.password or parts.query or parts.fragment:
        raise AgentError(f"agent '{text}': an address is ws://HOST:PORT[/PATH], without user, password, ? or #.")
    return AgentReference(form="served", text=text, source=text, name=f"{parts.hostname}-{port}", url=text)


def _guess(text: str) -> str:
    """A suggestion as a question, or nothing."""
    head, colon, tail = text.partition(":")
    meant = ""
    if "://" in text:
        address = tail.lstrip("/").partition("/")[0]
        numbered = re.search(r":\d+$", address)
        scheme = "wss" if head in ("wss", "https") else "ws"
        meant = f"{scheme}://{address if numbered else address.partition(':')[0] + ':PORT'}"
    elif ".py::" in text:
        meant = text.replace("::", ":")
    elif colon and difflib.get_close_matches(head.lower(), _COMMANDS, n=1, cutoff=0.7):
        meant = f"cmd:{tail.strip()}"
    elif Path(f"{text}.py").is_file():
        meant = f"{text}.py"
    elif text.endswith(".py:"):
        meant = text[:-1]
    elif re.fullmatch(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)+", text):
        meant = f"{text}:Agent"
    elif "/" in text and shutil.which(text.split()[0]):
        meant = f"cmd:{text}"
    return f"Did you mean '{meant}'? " if meant else ""


def _parse_command(text: str) -> tuple[str, ...]:
    """The words of a command as it will be started, with absolute paths of the program and of files.

    For a script that names its interpreter by ``env``, the interpreter comes first: a confined program cannot start it.
    """
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise AgentError(
            f"agent 'cmd:{text}': {error}. Write it as in a shell, such as cmd:'node my_agent.js'."
        ) from None
    if not words:
        raise AgentError("agent 'cmd:' names no program. Write cmd:PROGRAM ARGS, such as 'cmd:node my_agent.js'.")
    return (*_found(words[0], text), *(os.path.abspath(word) if Path(word).is_file() else word for word in words[1:]))


def _found(program: str, text: str) -> list[str]:
    path = shutil.which(program)
    if path is None:
        reason = "is not executable (chmod +x)" if Path(program).is_file() else "was not found"
        raise AgentError(f"agent 'cmd:{text}': the program '{program}' {reason}.")
    path = os.path.abspath(path)
    try:
        with open(path, "rb") as file:
            first = file.readline(256)
    except OSError:
        return [path]
    line = first[2:].decode(errors="replace").split() if first.startswith(b"#!") else []
    if not line or line[0] not in _ENV:
        return [path]
    rest = line[2:] if line[1:2] == ["-S"] else line[1:]
    if not rest or rest[0].startswith("-") or "=" in rest[0]:
        raise AgentError(f"{path}: its first line must name an interpreter: '#!/usr/bin/env NAME', got {first!r}.")
    return [*_found(rest[0], text), *rest[1:], path]


def own_files(words: Sequence[str]) -> list[Path]:
    """The files of a command that do not come with the machine or with this Python."""
    files = [Path(word) for word in words if os.path.isabs(word) and Path(word).is_file()]
    return [path for path in files if not _comes_with_the_machine(path)]


def _comes_with_the_machine(path: Path) -> bool:
    """Whether a program is in a folder of the system or of this Python, or links to such a program."""
    return any(place.is_relative_to(root) for place in (path, path.resolve()) for root in _SYSTEM)


def _bare(word: str) -> str:
    """A word of a command without folders of this machine."""
    return Path(word).name if os.path.isabs(word) else word
