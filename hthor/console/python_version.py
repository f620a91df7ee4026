"""Says which Python hthor needs when it is started with another Python. Any Python 3 can read this file."""

import sys

_VERSIONS = ((3, 11), (3, 12))


def check():  # type: ignore[no-untyped-def]  # no annotations: older versions read this
    """Exit with code 2 and one clear line, unless this Python can run hthor."""
    if sys.version_info[:2] not in _VERSIONS:
        given = ".".join(str(part) for part in sys.version_info[:3])
        sys.stderr.write(
            "error: hthor needs Python 3.11 or 3.12, this is Python " + given + " (" + sys.executable + ").\n"
        )
        sys.exit(2)
