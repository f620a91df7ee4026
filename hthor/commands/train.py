"""`hthor train`: robots that learn, by themselves or from an expert, and how well they find things."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from hthor.commands.options import Json
from hthor.console import output

if TYPE_CHECKING:
    from hthor.train.comparison import Comparison
    from hthor.train.resampling import Rating

app = typer.Typer(no_args_is_help=True, help="Train robots that learn to find things (needs the extra torch).")

_HOUSES = {"slim": 96, "paper": 12}
"""How many houses to train in unless told: codes of pictures take 40 MB an arrangement, and half a minute to make."""
_UNITS = {"k": 1_000, "M": 1_000_000}


def _count(text: str) -> int:
    """A number such as 500k or 10M."""
    number, unit = (text[:-1], _UNITS[text[-1]]) if text[-1:] in _UNITS else (text, 1)
    try:
        count = round(float(number) * unit)
    except ValueError:
        count = 0
    if count < 1:
        raise typer.BadParameter(f"{text!r} is not a number such as 250000, 500k or 10M.")
    return count


Out = Annotated[Path | None, typer.Option(help="Folder of the training.", show_default="training/ALGORITHM-SEED")]
Frames = Annotated[int, typer.Option(parser=_count, metavar="NUMBER", help="Actions to train on, such as 500k or 10M.")]
Seed = Annotated[int, typer.Option(min=0, help="The same seed gives the same network on the same kind of processor.")]
Houses = Annotated[int, typer.Option(min=1, help="Number of houses to train in.")]
HousesOfProfile = Annotated[
    int | None,
    typer.Option("--houses", min=1, help="Number of houses to train in.", show_default="96, with --profile paper 12"),
]
Arrangements = Annotated[int, typer.Option(min=1, help="Number of arrangements of the objects in each house.")]
ZonesName = Literal["rooms", "houses", "both"]
Zones = Annotated[
    ZonesName,
    typer.Option(help="Whether the robot searches a single room, the whole house, or half of the time each."),
]
Batch = Annotated[int, typer.Option(min=1, help="Number of episodes at once.")]
Begin = Annotated[
    Path | None,
    typer.Option(metavar="CHECKPOINT", help="Start from this checkpoint.", show_default="random weights"),
]
Profile = Annotated[
    Literal["slim", "paper"],
    typer.Option(help="slim: a small network that reads labels. paper: the published one, which reads pictures."),
]
Encoder = Annotated[
    Path | None,
    typer.Option(metavar="FOLDER", help="Encoder of pictures for --profile paper.", show_default="hthor's own"),
]
Set = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="KEY=VALUE",
        help="Another value for a setting in train_config.json, such as entropy=0.02 or network.hidden=256. Repeat the "
        "option for several.",
        show_default=False,
    ),
]
Every = Annotated[int, typer.Option(parser=_count, metavar="NUMBER", help="Actions between two validations.")]
Device = Annotated[str, typer.Option(help="auto, cpu or cuda; auto is cuda where there is one.")]
Jobs = Annotated[int | None, typer.Option(min=1, help="Processes that prepare the houses.", show_default="one per CPU")]
Quiet = Annotated[bool, typer.Option("--quiet", help="Print the result only, no progress.")]

EncoderOut = Annotated[
    Path | None, typer.Option("--out", help="Folder of the training.", show_default="training/encoder-SEED")
]
NumberOfPictures = Annotated[
    int, typer.Option("--pictures", parser=_count, metavar="NUMBER", help="Pictures to train on, such as 50k.")
]
Each = Annotated[int, typer.Option(min=1, help="Number of different pictures from each house.")]

Checkpoints = Annotated[
    list[Path] | None,
    typer.Argument(
        metavar="CHECKPOINT...",
        help="Folders of trainings; the first one is compared with the others.",
        show_default="those of savn and a2c that come with hthor",
    ),
]
TestHouses = Annotated[int, typer.Option("--houses", min=2, help="Number of new houses, and of houses of training.")]
TestZones = Annotated[
    ZonesName, typer.Option("--zones", help="Whether to search in single rooms, whole houses, or both.")
]
Episodes = Annotated[int, typer.Option(min=1, help="Number of episodes in each house.")]
Report = Annotated[
    Path | None, typer.Option("--out", metavar="FILE", help="Write everything to this JSON file.", show_default=False)
]

_SHARES = ("success", "spl", "success_long", "spl_long")
_HEADINGS = ("validation", "success", "SPL", "success, 5 actions or more", "SPL, 5 or more", "actions")
_RESUMES = (
    "Stopped by Ctrl-C or SIGTERM, the same command goes on where it was. 'hthor eval --agent savn:FOLDER' evaluates "
    "the result beside people."
)


def train(
    context: typer.Context,
    out: Out = None,
    frames: Frames = "10M",  # type: ignore[assignment]  # parsed
    seed: Seed = 0,
    houses: HousesOfProfile = None,
    arrangements: Arrangements = 2,
    zones: Zones = "both",
    batch: Batch = 64,
    begin: Begin = None,
    profile: Profile = "slim",
    encoder: Encoder = None,
    settings: Set = None,
    every: Every = "500k",  # type: ignore[assignment]
    device: Device = "auto",
    jobs: Jobs = None,
    quiet: Quiet = False,
    json: Json = False,
) -> None:
    """Train a network by the algorithm that the command is named after."""
    from hthor.train import algorithms, session, training_display

    name = context.info_name or ""
    learner, config = algorithms.make(name, settings or (), profile, seed=seed, frames=frames, batch=batch)
    setup = session.Setup(
        algorithm=name,
        out=out or Path("training") / f"{name}-{seed}",
        houses=houses or _HOUSES[profile],
        arrangements=arrangements,
        zones=zones,
        every=every,
        device=device,
        jobs=jobs,
        begin=begin,
        encoder=encoder,
    )
    with training_display.watch(name, shown=not quiet) as watcher:
        row = session.run(learner, config, setup, watcher)
    if row is None:
        raise KeyboardInterrupt
    if json:
        output.put_json({"folder": str(setup.out), **row})
        return
    output.put_table(_HEADINGS, [_cells(zone, row[zone]) for zone in ("rooms", "houses") if zone in row])
    output.say(f"files: {setup.out}/model.safetensors, config.json, train_config.json, metrics.jsonl")
    output.say(f"next:  hthor eval --agent none --agent savn:{shlex.quote(str(setup.out))} --humans proxy")


def train_encoder(
    out: EncoderOut = None,
    pictures: NumberOfPictures = "400k",  # type: ignore[assignment]  # parsed
    seed: Seed = 0,
    houses: Houses = 96,
    each: Each = 300,
    device: Device = "auto",
    jobs: Jobs = None,
    quiet: Quiet = False,
    json: Json = False,
) -> None:
    """Train the encoder of pictures that networks of the profile paper see with.

    It learns to name what each of 7 x 7 cells of the robot's picture shows, and how far off that is. Stopped by Ctrl-C
    or SIGTERM, the same command goes on where it was.
    """
    from hthor.train import encoder, training_display

    folder = out or Path("training") / f"encoder-{seed}"
    config = encoder.Config(seed=seed, houses=houses, each=each, pictures=pictures)
    with training_display.watch("encoder", shown=not quiet) as watcher:
        row = encoder.train(config, folder, device, jobs, watcher)
    if row is None:
        raise KeyboardInterrupt
    if json:
        output.put_json({"folder": str(folder), **row})
        return
    found = row["validation"]
    shares = (f"{100.0 * found[name]:.1f} %" for name in ("right", "small_found", "small_right"))
    output.put_table(
        ("in new houses", "cells named rightly", "things found", "things right", "error of ranges"),
        [("validation", *shares, f"{found['range_error_m']:.2f} m")],
    )
    output.say(f"files: {folder}/encoder.safetensors, train_config.json, metrics.jsonl")
    output.say(f"next:  hthor train a2c --profile paper --encoder {shlex.quote(str(folder))}")


def compare(
    checkpoints: Checkpoints = None,
    houses: TestHouses = 24,
    episodes: Episodes = 25,
    zones: TestZones = "both",
    jobs: Jobs = None,
    out: Report = None,
    quiet: Quiet = False,
    json: Json = False,
) -> None:
    """Let robots look for things, alone, and compare a trained one with the others.

    The episodes are the same for all robots and in every call with the same --episodes. Most are in houses that no
    training sees. The first checkpoint is also tried without sight, with another goal, without adaptation, with an
    ideal detector, with "here it is" said for it, and with a map. Give the checkpoints of several seeds of a training
    to try them as one robot. Intervals come from a bootstrap over houses and checkpoints.
    """
    from hthor import jsonio
    from hthor.train import comparison, grid_worlds, groups, training_display

    chosen = checkpoints or [groups.SHIPPED / name for name in ("savn", "a2c")]
    setup = comparison.Setup(
        houses=houses, episodes=episodes, zones=grid_worlds.BOTH if zones == "both" else (zones,), jobs=jobs
    )
    with training_display.watch("eval", shown=not quiet) as watcher:
        found = comparison.compare(groups.load_groups(chosen), setup, watcher)
    if out is not None:
        jsonio.write(out, jsonio.pretty(found))
    if json:
        output.put_json(found)
        return
    for zone in setup.zones:
        _show(found, zone)
    output.say(
        f"{found.episodes} episodes in each of {found.houses['test']} new houses; success in %, 'long' that of "
        f"episodes of at least 5 actions, 'training' that in {found.houses['train']} houses of training"
    )
    if out is not None:
        output.say(f"file: {out}")


def _show(found: Comparison, zone: str) -> None:
    """The table of one kind of zones."""
    rows = [row for row in found.rows if row.zones == zone]
    known = {row.robot: row.success for row in rows if row.split == "train"}
    less = {one.other: one.success for one in found.differences if one.zones == zone}
    robot = found.differences[0].robot
    output.put_table(
        (f"in {zone}", "success", "95 %", "SPL", "long", "training", f"{robot} minus it"),
        [
            (
                row.robot.removeprefix(f"{robot}, ") + (f" ({row.checkpoints})" if row.checkpoints > 1 else ""),
                _mean(row.success),
                _interval(row.success),
                f"{row.spl.mean:.3f}",
                _mean(row.success_long),
                _mean(known[row.robot]) if row.robot in known else "",
                _difference(less[row.robot]) if row.robot in less else "",
            )
            for row in rows
            if row.split == "test"
        ],
    )


def _mean(rating: Rating) -> str:
    return "–" if rating.mean is None else f"{100.0 * rating.mean:.1f}"


def _interval(rating: Rating) -> str:
    return "–" if rating.ci95 is None else "…".join(f"{100.0 * end:z.1f}" for end in rating.ci95)


def _difference(rating: Rating) -> str:
    return "–" if rating.mean is None else f"{100.0 * rating.mean:+z.1f} ({_interval(rating)})"


def _cells(zone: str, found: dict[str, float]) -> tuple[str, ...]:
    return (
        zone,
        *(f"{100.0 * found[name]:.1f} %" if "success" in name else f"{found[name]:.3f}" for name in _SHARES),
        f"{found['actions']:.0f}",
    )


for _name, _words in {
    "savn": "Train SAVN: an actor-critic that adapts to each episode, by a loss that is learned too.",
    "a2c": "Train the same actor-critic without adaptation.",
    "bc": "Train the same network to imitate an expert who knows the shortest path.",
}.items():
    app.command(_name, help=f"{_words}\n\n{_RESUMES}")(train)
app.command("encoder")(train_encoder)
app.command("eval")(compare)
