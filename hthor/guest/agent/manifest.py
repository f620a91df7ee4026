"""What an agent consists of: a list of files with hashes, and its arguments."""

from collections.abc import Iterable

from msgspec import Struct

from hthor import jsonio


class File(Struct, frozen=True, kw_only=True, order=True):
    """One file of an agent.

    ``path`` is relative to the agent's folder, with slashes; outside of it (``--readable``) it begins with ``../`` and
    the name of the file or folder that was made readable.
    """

    path: str
    sha256: str
    bytes: int


class Manifest(Struct, frozen=True, kw_only=True):
    """An agent's identity.

    Attributes:
        name, source: as in `AgentRef`.
        sha256: as in `AgentRef`: the hash of source, arguments, files and library; of a served agent, of its server's
            description.
        args: the ``--agent-args``; files appear by their path in ``files``.
        files: sorted by path.
        library: hash of the modules of hthor that its files import, directly or not; empty without Python files.
        claimed: whether this is only what the agent's server says.
    """

    name: str
    source: str
    sha256: str
    args: dict[str, str] = {}
    files: tuple[File, ...] = ()
    library: str = ""
    claimed: bool = False


def make_manifest(name: str, source: str, args: dict[str, str], files: Iterable[File], library: str = "") -> Manifest:
    """The manifest of an agent that runs here."""
    kept = tuple(sorted(set(files)))
    args = dict(sorted(args.items()))
    sha256 = jsonio.sha256({"source": source, "args": args, "files": kept, "library": library})
    return Manifest(name=name, source=source, sha256=sha256, args=args, files=kept, library=library)


def differences(there: Iterable[File], here: Iterable[File]) -> list[str]:
    """The differences between two lists of files, a few words for each."""
    before, now = ({file.path: file.sha256 for file in files} for files in (there, here))
    words = []
    for path in sorted({*before, *now}):
        if path not in now:
            words.append(f"{path} is gone")
        elif path not in before:
            words.append(f"{path} is new")
        elif before[path] != now[path]:
            words.append(f"{path} has changed")
    return words
