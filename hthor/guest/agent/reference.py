"""Finds the submitted agent that a user names, without importing or starting it.

Every command that takes an agent parses it here, so that all accept the same forms.
"""

import difflib
import re
import shutil
import sys
from pathlib import Path
from urllib.parse import urlsplit

from msgspec import Struct

from hthor import plugins
from hthor.errors import AgentError, UnknownName
from hthor.guest.agent import command, digests

FORMS = ("my_agent.py", "my_agent.py:Class", "package.module:Class", "cmd:PROGRAM ARGS", "ws://HOST:PORT[/PATH]")
"""The ways to name an agent that is not built in."""
HINT = f"An agent of your own is {', '.join(FORMS)} or wss://...; see docs/agents.md."
_MODULE = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*:[A-Za-z_]\w*")
_COMMANDS = ("cmd", "command", "exec", "run", "program", "process", "shell")


class AgentReference(Struct, frozen=True, kw_only=True):
    """An agent before anything of it runs.

    Attributes:
        form: file, module, command or served.
        text: names the same agent for another process of this machine, in any working folder.
        source: its name in results, without folders of this machine.
        name: its name, unless it gives another one.
        path: the file that is imported or started; empty when it is served.
        root: its own folder, which it may read; empty for none.
        cls: the class to use, empty for the only one. module: its name, where it is imported by name.
        words: the program and its arguments. url: of the server.
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

    @property
    def sha256(self) -> str:
        """Hash of its file, or of its command with the files that it names; empty when it is served.

        Raises:
            AgentError: when a file cannot be read.
        """
        if self.words:
            return command.command_sha256(self.words)
        return digests.file_sha256(Path(self.path)) if self.path else ""


def is_served(text: str) -> bool:
    """Whether this text names an agent that runs elsewhere."""
    return "://" in text


def parse_reference(text: str, cls: str | None = None) -> AgentReference:
    """Parse what a user typed.

    Raises:
        UnknownName: when it has none of the forms.
        AgentError: when it has one, but there is no such module, program or address.
    """
    if text.startswith("cmd:"):
        return _command(text)
    if "://" in text:
        return _served(text)
    file, colon, named = text.rpartition(":") if ".py:" in text else (text, "", "")
    if file.endswith(".py"):
        return _file(Path(file), cls or named, colon)
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
    words = command.parse_command(text.removeprefix("cmd:"))
    own = command.own_files(words)
    return AgentReference(
        form="command",
        text=command.as_text(words),
        source=command.as_source(words),
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
