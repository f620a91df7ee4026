"""`hthor eval --dry-run`."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from hthor.console import output

if TYPE_CHECKING:
    import typer

    from hthor.eval.dry_run import Forecast, RunForecast, TrialCost
    from hthor.eval.runner.progress import Watcher
    from hthor.eval.runner.run_options import ResolvedRuns, RunOptions

_LEFT_OUT = ("json", "quiet", "dry_run", "context")
_ORIGINS = {"COMMANDLINE": "flag", "ENVIRONMENT": "environment", "DEFAULT": "default", "DEFAULT_MAP": "default"}


def show_forecast(options: RunOptions, watcher: Callable[[str], Watcher], context: typer.Context, json: bool) -> None:
    """Say what the command would do."""
    from hthor.eval import dry_run
    from hthor.eval.runner import experiment

    names = [str(one.name) for one in context.command.params if one.name in context.params]
    origins = {name: _origin(context, name) for name in names if name not in _LEFT_OUT}
    found: list[Forecast] = []

    def agree(intent: ResolvedRuns) -> bool:
        found.append(dry_run.make_forecast(options, intent, origins, output.say))
        return False

    for _ in experiment.run_experiment(options, watcher, agree):
        raise AssertionError("a dry run plays nothing")
    if json:
        output.put_json(found[0])
    else:
        _put(found[0])


def _origin(context: typer.Context, name: str) -> str:
    source = context.get_parameter_source(name)
    return _ORIGINS.get(source.name if source is not None else "DEFAULT", "flag")


def _put(found: Forecast) -> None:
    settings = [(one.name.replace("_", "-"), _value(one.value), one.origin) for one in found.settings]
    output.put_table(("option", "value", "from"), settings)
    output.put_table(("run", "folder", "trials", "played", "time"), [_row(one) for one in found.runs])
    held = found.isolation
    why = f" ({held.reason_not_higher})" if held and held.reason_not_higher else ""
    output.put_line(f"isolation: {held.level if held else 'none, as all agents are built in'}{why}")
    for words in dict.fromkeys(_source(one.pace) for one in found.runs if one.pace):
        output.put_line(f"time: {words}")
    if found.seconds is None:
        output.put_line("time: unknown where no finished run here has the same robots, and their trial took too long")
    left, about = found.trials - found.played, f", {time(found.seconds)}" if found.seconds is not None else ""
    output.put_line(f"{left} of {found.trials} trials would be played{about}; nothing was written.")


def _source(pace: TrialCost) -> str:
    """How it is known what a trial takes."""
    if pace.folder:
        return f"as in {pace.folder}/"
    return f"estimated from {pace.played} trial{'s' * (pace.played != 1)} played for it, which are kept nowhere"


def _row(one: RunForecast) -> tuple[object, ...]:
    return one.name, f"{one.folder}/", one.trials, one.played, time(one.seconds) or "unknown"


def time(seconds: float | None) -> str:
    """How long something takes, for people; empty where nobody knows."""
    if seconds is None:
        return ""
    minutes, rest = divmod(round(seconds), 60)
    return f"about {minutes} min {rest:02d} s" if minutes else f"about {rest} s"


def _value(value: object) -> object:
    if value is None or value == "":
        return "–"
    return {True: "yes", False: "no"}.get(value, value) if isinstance(value, bool) else value
