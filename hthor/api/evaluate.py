"""`hthor.evaluate`: evaluates agents from a script or a notebook, with the options of `hthor eval`."""

import inspect
import os
import sys
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from typing import Any, Literal

from hthor import activity
from hthor.api import agent_class, notebook
from hthor.api.evaluation import Evaluation
from hthor.console import output
from hthor.eval.config.option import Field, fields, make_record
from hthor.eval.config.options import EvalOptions
from hthor.eval.planning.resolve import resolve
from hthor.eval.runner import experiment
from hthor.eval.runner.progress import Watcher, make_watcher

Agent = str | os.PathLike[str] | type
"""An agent: its name or file as on the command line, or its class."""


def evaluate(agent: Agent | Sequence[Agent] = (), *, progress: bool = True, **options: object) -> Evaluation:
    """Evaluate robots that help people with a suite of tasks, as `hthor eval` does.

    The same call again resumes an interrupted run, and only scores a finished one. Options have the names, defaults and
    ranges of the command line; one that can be repeated takes a value or a list.

    Args:
        agent: the agent, or several to compare: a name, a file, or a class, which may be defined in a notebook.
        progress: whether to show how far it is: a bar in a notebook or on a terminal, otherwise plain lines.
        options: all others are listed below.

    Raises:
        HthorError: when an option is wrong, or a run could not be finished. Agents that fail are counted as faults in
            the result.
    """
    agents = agent if isinstance(agent, (list, tuple)) else [agent]
    words = [agent_class.agent_word(one) for one in agents]
    given = {**options, "agent": words, "agent_args": _argument_words(options.get("agent_args"))}
    record = make_record(EvalOptions, given)
    say = output.say if progress else _ignore
    with _main_stays_here(), activity.read_by(say) if progress else nullcontext():
        resolved = resolve(record, say)
        done = [
            (str(one.folder), one.result)
            for one in experiment.run_experiment(resolved, lambda title: _make_watcher(title, shown=progress))
        ]
    return Evaluation.of(done)


def _argument_words(given: object) -> object:
    """Arguments of agents as the command line writes them; they may be given as a dictionary."""
    return [f"{key}={value}" for key, value in given.items()] if isinstance(given, Mapping) else given


def _make_watcher(title: str, *, shown: bool) -> Watcher:
    if shown and notebook.is_here():
        return notebook.NotebookBar(title)
    return make_watcher(output.console(talk=True), title, quiet=not shown, live=output.live())


@contextmanager
def _main_stays_here() -> Iterator[None]:
    """Within the block, new processes do not import the script that is running.

    They would otherwise run it again from its first line, unless all of it stands below ``if __name__ == "__main__"``.
    No worker needs it: agents are loaded from their own files.
    """
    main = sys.modules["__main__"]
    names: tuple[str, ...] = ("__file__", "__spec__")
    hidden: dict[str, Any] = {name: vars(main).pop(name) for name in names if name in vars(main)}
    main.__spec__ = None
    try:
        yield
    finally:
        vars(main).update(hidden)


def _ignore(words: str) -> None:
    del words


def _describe(one: Field) -> str:
    """An option's line of the docstring."""
    default = one.about.default or (repr(one.default) if one.default not in (None, "", ()) else "")
    text = f"{one.name}: {one.about.help}{f' Default: {default}.' if default else ''}"
    return textwrap.fill(text, 116, initial_indent=" " * 4, subsequent_indent=" " * 8)


def _parameter(one: Field) -> inspect.Parameter:
    kind: Any = Literal[one.choices] if one.choices else one.types[0]
    for other in one.types[1:]:
        kind |= other
    if one.repeated:
        kind |= Sequence[kind]
    if one.default is None:
        kind |= None
    return inspect.Parameter(one.name, inspect.Parameter.KEYWORD_ONLY, default=one.default, annotation=kind)


def _present() -> None:
    """Give `evaluate` the signature and the documentation of its options, which editors and notebooks show."""
    own = inspect.signature(evaluate)
    others = [one for one in fields(EvalOptions).values() if one.name != "agent"]
    first, shown, _ = own.parameters.values()
    evaluate.__signature__ = own.replace(parameters=[first, *map(_parameter, others), shown])  # type: ignore[attr-defined]
    lines = "\n".join(map(_describe, others))
    evaluate.__doc__ = f"{inspect.cleandoc(evaluate.__doc__ or '')}\n\nOptions:\n{lines}\n"


_present()
