"""The guest's side: ``python -m hthor.guest READ WRITE PARENT``; knows only its two pipes."""

from __future__ import annotations

import sys

from hthor.guest.child import main

if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]))
