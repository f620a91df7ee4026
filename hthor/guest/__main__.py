"""The guest's side: ``python -m hthor.guest READ TELL WRITE PARENT``; knows only its pipes."""

from __future__ import annotations

import sys

from hthor.guest.keeper import main

if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:5]))
