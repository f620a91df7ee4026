"""hthor: people and robots share a simulated house, and the robot's help is measured."""

__version__ = "0.1.0"


def __getattr__(name: str) -> object:
    """Import what is used from Python when it is first used, so that ``import hthor`` costs nothing."""
    if name == "evaluate":
        import importlib

        return importlib.import_module("hthor.api.evaluate").evaluate
    raise AttributeError(f"module 'hthor' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted([*globals(), "evaluate"])
