"""`python -m hthor` is `hthor`."""

from hthor.cli import main

if __name__ == "__main__":
    main()
