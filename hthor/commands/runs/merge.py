"""`hthor merge`."""

from pathlib import Path
from typing import Annotated

import typer

from hthor.commands.options import Json
from hthor.console import output

_MISSING_EXIT, _FAULTS_EXIT = 1, 3


def merge(
    folders: Annotated[list[Path], typer.Argument(metavar="FOLDER...", help="The folders of the shards.")],
    out: Annotated[Path, typer.Option(help="The folder of the whole run.")],
    json: Json = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Print how many trials there would be; write nothing.")
    ] = False,
) -> None:
    """Join the shards of a run, played with 'hthor eval --shard I/N'.

    The result equals that of an undivided run byte for byte, except for its cost. If trials are missing, the command
    prints the commands that play them; merge again afterwards.
    """
    from hthor.eval.merge import merge_shards as merging

    done = merging.merge_shards(folders, out, dry=dry_run)
    if json:
        output.put_json(done)
    elif done.result is not None:
        from hthor.report.terminal import result_tables

        output.console().print(result_tables.result_table(done.result))
        for note in result_tables.result_notes([done.result]):
            output.put_line(note)
    if dry_run:
        would = f"{done.trials} of {done.plan.trials} trials would be in {out}/, {done.new} of them new"
        output.say(f"{would}; nothing was written.")
        raise typer.Exit(0 if done.trials == done.plan.trials else _MISSING_EXIT)
    output.say(f"{done.trials} of {done.plan.trials} trials are in {out}/, {done.new} of them new.")
    if done.result is not None:
        if done.result.counts.faults:
            raise typer.Exit(_FAULTS_EXIT)
        return
    for gap in done.gaps:
        lacks = "is missing" if gap.trials is None else f"lacks {gap.trials} trials"
        output.say(f"{f'shard {gap.number}/{gap.of}' if gap.of > 1 else 'the run'} {lacks}: {gap.command}")
    for name in dict.fromkeys(seat.agent.source.partition(":")[0] for seat in done.plan.robots):
        if name.endswith(".py"):
            output.say(f"Replace {name} by the path of the agent's file.")
    if any(gap.of > 1 for gap in done.gaps):
        output.say("Then merge again.")
    raise typer.Exit(_MISSING_EXIT)
