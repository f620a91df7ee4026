"""Built-in agents, one file each, and the template for a new one. Begin with `frontier`.

An agent file defines ``class Agent`` with ``begin(briefing)`` and ``act(observation) -> Action``, see
`hthor.types.Mind`. Optional class attributes: ``privileges`` (some of "ideal_detector", "object_poses", "house_map",
"pixel_labels"; they are printed with every result), ``robots`` (names of the bodies it is made for; empty: any),
``absent`` (True: there is no robot at all), ``ingredients`` (names of files beside the agent's own that it is made of,
such as weights: they ship with hthor and count in the agent's identity). A constructor may take arguments that all have
defaults; an argument ``checkpoint`` is a file or folder, which users can name as in ``savn:runs/mine/best``.
"""

from pathlib import Path

from hthor import jsonio
from hthor.errors import AgentError

_TEMPLATE = Path(__file__).with_name("_template.py.txt")


def template() -> str:
    """The text of a small agent that works as it is."""
    return _TEMPLATE.read_text(encoding="utf-8")


def write_template(path: str | Path, force: bool = False) -> Path:
    """Write the template to ``path`` and return it.

    Raises:
        AgentError: when the name does not end in .py, or the file exists and ``force`` is not given.
    """
    path = Path(path)
    if path.suffix != ".py":
        raise AgentError(f"an agent is one Python file, its name must end in .py, got '{path.name}'.")
    if path.exists() and not force:
        raise AgentError(f"{path} exists already. Choose another name, or overwrite it with --force.")
    jsonio.write(path, template().encode())
    return path
