"""Starts a guest's supervisor: ``python -m hthor.guest SOCKET PARENT``."""

import sys

from hthor.guest.supervisor.supervisor import main

if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:3]))
