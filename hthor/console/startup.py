"""Before a command runs: standard streams that exist, and arguments that are text."""

import contextlib
import os
import sys


def open_streams() -> None:
    """Give a process that was started without standard streams, as some job runners do, empty ones."""
    for handle, name, mode in ((0, "stdin", "r"), (1, "stdout", "w"), (2, "stderr", "w")):
        if getattr(sys, name) is None:
            if (null := os.open(os.devnull, os.O_RDWR)) != handle:
                os.dup2(null, handle)
                os.close(null)
            os.set_inheritable(handle, True)
            setattr(sys, name, os.fdopen(handle, mode))


def check_arguments() -> None:
    """Refuse names that are not UTF-8: file names may be any bytes, but what hthor writes is UTF-8.

    Raises:
        HthorError: naming the argument or the working folder.
    """
    from hthor.errors import HthorError
    from hthor.jsonio import is_text

    for given in sys.argv[1:]:
        if not is_text(given):
            raise HthorError(f"{given!a} is not UTF-8. Rename the file or folder, or type the name again.")
    with contextlib.suppress(OSError):
        if not is_text(os.getcwd()):
            raise HthorError(f"the name of this folder, {os.getcwd()!a}, is not UTF-8. Rename it, or go elsewhere.")
