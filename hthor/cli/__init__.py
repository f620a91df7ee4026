"""The command line. This file runs on any Python 3, to be able to say which one is needed."""

import sys

_VERSIONS = ((3, 11), (3, 12))


def main() -> None:
    """Run `hthor` with the arguments of this process."""
    if sys.version_info[:2] not in _VERSIONS:
        given = ".".join(str(part) for part in sys.version_info[:3])
        sys.stderr.write(
            "error: hthor needs Python 3.11 or 3.12, this is Python " + given + " (" + sys.executable + ").\n"
        )
        sys.exit(2)
    from hthor.cli.app import run

    run()
