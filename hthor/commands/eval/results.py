"""What `hthor eval` prints of finished runs."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING

from hthor.console import output

if TYPE_CHECKING:
    from rich.console import Console

    from hthor.eval.comparison.population_matrix import PopulationMatrix
    from hthor.eval.runner.experiment import FinishedRun


def show_run(console: Console, one: FinishedRun) -> None:
    """Print a run's table, its first fault, its files and the next commands."""
    from hthor.eval.config.sessions import whole_folder
    from hthor.eval.records import find
    from hthor.eval.runner import fault_report
    from hthor.leaderboard.entries import overrides
    from hthor.report.terminal import result_tables

    result, config, folder = one.result, one.config, one.folder.path
    console.print(result_tables.result_table(result))
    if result.counts.faults:
        faulty, many = find.first_fault(one.folder), f"{result.counts.faults} of {result.counts.trials}"
        alone = (
            "there the person continued alone" if len(config.seats) == 1 else "there the others continued without it"
        )
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
    unranked = overrides.overridden_settings(config)
    if unranked:
        why = ", ".join(f"{name.replace('_', '-')} is {value}" for name, value in unranked.items())
        output.say(f"not for the leaderboard: {why}", console)
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
