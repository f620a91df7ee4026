"""What `hthor eval` prints: about finished runs and, with --dry-run, about runs that it would play."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING

from hthor.console import output

if TYPE_CHECKING:
    import typer
    from rich.console import Console

    from hthor.eval.comparison.population_matrix import PopulationMatrix
    from hthor.eval.dry_run import Forecast, RunForecast, TrialCost
    from hthor.eval.runner.experiment import FinishedRun
    from hthor.eval.runner.run_job import ResolvedRuns

_ORIGINS = {"COMMANDLINE": "flag", "ENVIRONMENT": "environment", "DEFAULT": "default", "DEFAULT_MAP": "default"}


def show_run(console: Console, one: FinishedRun) -> None:
    """Print a run's table, its first fault, its files and the next commands."""
    from hthor.eval.config.shards import whole_folder
    from hthor.eval.records import find
    from hthor.eval.runner import fault_report
    from hthor.leaderboard.entries import overrides
    from hthor.report.terminal import result_tables

    result, config, folder = one.result, one.config, one.folder.path
    console.print(result_tables.result_table(result))
    if result.counts.faults:
        faulty, many = find.first_fault(one.folder), f"{result.counts.faults} of {result.counts.trials}"
        others = "the person continued alone" if len(config.humans.members) == 1 else "the people continued alone"
        alone = f"there {others if len(config.seats) == 1 else 'the others continued without it'}"
        failed = [f"{seat} in {count}" for seat, count in result.counts.faults_by_seat.items() if count]
        whose = f" ({', '.join(failed)})" if len(config.seats) > 1 else ""
        output.say(f"{'An' if whose else 'The'} agent failed in {many} trials{whose}; {alone}.", console)
        kinds = ", ".join(f"{count} {kind}" for kind, count in result.counts.faults_by_kind.items())
        output.say(f"Faults by kind: {kinds}.", console)
        output.say(f"First in trial {faulty.key} ({faulty.spec.task.id}), {find.fault_words(faulty)}", console)
        for line in find.fault_lines(faulty):
            output.say(f"    {line}", console)
        if again := fault_report.rerun_command(folder, faulty.key):
            output.say(f"see:   {again}", console)
    more = ", suite.json" if (folder / "suite.json").exists() else ""
    if config.shard:
        base, of = shlex.quote(str(whole_folder(folder))), config.shard.of
        output.say(f"shard {config.shard.words} is done: {result.counts.trials} of {config.trials} trials", console)
        output.say(f"files: {folder}/run.json, trials.jsonl{more}", console)
        output.say(f"next:  hthor merge {base}-shard-*-of-{of} --out {base}", console)
        return
    output.say(f"files: {folder}/run.json, trials.jsonl, result.json{more}", console)
    run = shlex.quote(str(folder))
    settings = overrides.overridden_settings(config, played=result.counts.tasks)
    unranked = [f"{name.replace('_', '-')} is {value}" for name, value in settings.items()]
    unranked += ["its trials were corrected"] if result.corrections else []
    if unranked:
        output.say(f"not for the leaderboard: {', '.join(unranked)}", console)
    ranked = () if unranked else (f"hthor leaderboard add {run}",)
    for line in output.following(f"hthor replay {run} 0", f"hthor score {run} --all", *ranked):
        output.say(line, console)


def show_populations(console: Console, whole: PopulationMatrix) -> None:
    """Print all scores, the worst population for each agent, and conclusions that differ between populations."""
    from hthor.report.terminal import result_tables

    console.print(result_tables.population_table(whole))
    for line in result_tables.worst_population_lines(whole):
        output.say(line, console)
    for found in sorted(whole.conclusions, key=lambda one: one.verdict != "flips"):
        output.say(f"{'! ' if found.verdict == 'flips' else ''}{found.sentence}", console)
    if whole.conclusions and all(found.verdict != "flips" for found in whole.conclusions):
        output.say("every conclusion holds at both bounds", console)


def show_forecast(resolved: ResolvedRuns, context: typer.Context, json: bool) -> None:
    """Print what the command would do."""
    from hthor.eval import dry_run
    from hthor.eval.config.option import fields
    from hthor.eval.config.options import EvalOptions
    from hthor.eval.runner import experiment

    experiment.check_folders(resolved)
    origins = {name: _origin(context, name) for name in fields(EvalOptions)}
    found = dry_run.make_forecast(resolved, origins, output.say)
    if json:
        output.put_json(found)
    else:
        _put(found)


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
        output.put_line("time: unknown for robots that no finished run here has, and whose trial took too long")
    if found.design:
        output.put_line(found.design.sentence)
    left, about = found.trials - found.played, f", {time(found.seconds)}" if found.seconds is not None else ""
    output.put_line(f"{left} of {found.trials} trials would be played{about}; nothing was written.")


def _source(pace: TrialCost) -> str:
    """Where the estimated time of a trial comes from."""
    if pace.folder:
        return f"as in {pace.folder}/"
    return f"estimated from {pace.played} trial{'s' * (pace.played != 1)} played for it, which are not kept"


def _row(one: RunForecast) -> tuple[object, ...]:
    return one.name, f"{one.folder}/", one.trials, one.played, time(one.seconds) or "unknown"


def time(seconds: float | None) -> str:
    """A duration in words; empty if it is unknown."""
    if seconds is None:
        return ""
    minutes, rest = divmod(round(seconds), 60)
    return f"about {minutes} min {rest:02d} s" if minutes else f"about {rest} s"


def _value(value: object) -> object:
    if value is None or value in ("", ()):
        return "–"
    if isinstance(value, tuple):
        return list(value)
    return {True: "yes", False: "no"}.get(value, value) if isinstance(value, bool) else value
