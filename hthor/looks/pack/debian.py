"""Gets the library's files: from a Debian package file, from an installed package, or through apt."""

import io
import shutil
import subprocess
import tarfile
import tempfile
from collections.abc import Iterator
from pathlib import Path

from hthor.looks.pack.store import PackError

PACKAGE = "sweethome3d-furniture"
INSTALLED = Path("/usr/share/sweethome3d/furniture")
SUFFIX = ".sh3f"
_AR = b"!<arch>\n"
_HEADER = 60
_HOW = (
    f"Give the package with --deb FILE (Debian's '{PACKAGE}', all versions work), install it, or run this command "
    "where apt is."
)


def libraries(deb: Path | None) -> tuple[dict[str, bytes], str]:
    """Every library by name, and a description of where they came from.

    Args:
        deb: the Debian package's file; None uses the installed package, or else downloads it with apt.

    Raises:
        PackError: if there is no package, or it is broken or a different package.
    """
    if deb is not None:
        return _of_file(deb), deb.name
    installed = sorted(INSTALLED.glob(f"*{SUFFIX}"))
    if installed:
        return {path.stem: path.read_bytes() for path in installed}, f"{PACKAGE} as installed"
    with tempfile.TemporaryDirectory(prefix="hthor-assets-") as folder:
        file = _download(Path(folder))
        return _of_file(file), file.name


def _download(folder: Path) -> Path:
    apt = shutil.which("apt-get")
    if apt is None:
        raise PackError(f"there is no '{PACKAGE}' here and no apt-get to download it with. {_HOW}")
    done = subprocess.run([apt, "download", PACKAGE], cwd=folder, capture_output=True, text=True, check=False)
    files = sorted(folder.glob("*.deb"))
    if done.returncode or not files:
        lines = (done.stderr or done.stdout).strip().splitlines() or ["no reason given"]
        raise PackError(f"apt-get could not download '{PACKAGE}': {lines[-1]} {_HOW}")
    return files[0]


def _of_file(deb: Path) -> dict[str, bytes]:
    try:
        data = deb.read_bytes()
    except OSError as error:
        raise PackError(f"{deb}: {error.strerror or error}. {_HOW}") from None
    try:
        found = {Path(name).stem: content for name, content in _files(deb, data) if name.endswith(SUFFIX)}
    except (tarfile.TarError, EOFError, OSError, ValueError) as error:
        raise PackError(f"{deb} is a broken Debian package ({error}). Download it again.") from None
    if not found:
        raise PackError(f"{deb} holds no furniture library ({SUFFIX}); it must be Debian's '{PACKAGE}'.")
    return found


def _files(deb: Path, data: bytes) -> Iterator[tuple[str, bytes]]:
    for name, content in _members(deb, data):
        if name.startswith("data.tar"):
            if name.endswith(".zst"):
                content = _unzstd(deb, content)
            with tarfile.open(fileobj=io.BytesIO(content)) as archive:
                for member in archive:
                    handle = archive.extractfile(member) if member.isfile() else None
                    if handle is not None:
                        yield member.name, handle.read()


def _members(deb: Path, data: bytes) -> Iterator[tuple[str, bytes]]:
    """The files of an ar archive, which every Debian package is."""
    if not data.startswith(_AR):
        raise PackError(f"{deb} is not a Debian package: it does not begin with '!<arch>'. {_HOW}")
    place = len(_AR)
    while place + _HEADER <= len(data):
        header = data[place : place + _HEADER]
        length = int(header[48:58])
        content = data[place + _HEADER : place + _HEADER + length]
        if len(content) < length:
            raise EOFError("the archive ends in the middle of a file")
        yield header[:16].decode("ascii", "replace").strip().rstrip("/"), content
        place += _HEADER + length + length % 2


def _unzstd(deb: Path, content: bytes) -> bytes:
    tool = shutil.which("zstd")
    if tool is None:
        raise PackError(
            f"{deb} is packed with zstd, and the program 'zstd' is not installed. Install zstd, or unpack the "
            "file yourself."
        )
    return subprocess.run([tool, "-dc"], input=content, capture_output=True, check=True).stdout
