"""`hthor eval`."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from hthor.commands.eval import results
from hthor.commands.options import AgentArgs, Camera, CameraSize, Design, Json, Readable
from hthor.console import output

if TYPE_CHECKING:
    from hthor.eval.runner.experiment import FinishedRun

_FAULTS_EXIT = 3


def evaluate(
    agent: Annotated[
        list[str] | None,
        typer.Option(
            help="The agent to evaluate: the name of a built-in agent ('hthor agents list'); a Python file or module "
            "(my_agent.py, my_agent.py:MyClass, package.module:MyClass); a program ('cmd:node my_agent.js'); or a "
            "served agent (ws://host:port). Repeat the option to compare several agents.",
            show_default=False,
        ),
    ] = None,
    agent_args: AgentArgs = None,
    readable: Readable = None,
    humans: Annotated[
        list[str] | None,
        typer.Option(
            help="The people ('hthor humans list'): a population, a kind of people or a human model, by name or as a "
            "file (pop.npz, my_kind.json, my_human.py). cautious@pop.npz is the kind 'cautious' drawn from pop.npz. "
            "A comma joins the people of one trial: proxy,proxy. Repeat the option to run several populations one "
            "after the other; 'kinds' means the population and every kind of people; 'bracket' means the population "
            "and two bounds: people who accept every message and people who accept none.",
            show_default="proxy, the calibrated population",
        ),
    ] = None,
    suite: Annotated[
        str,
        typer.Option(
            help="The suite of tasks ('hthor tasks list'): a name or a file.", show_default="smoke, or the kind's own"
        ),
    ] = "",
    kind: Annotated[
        str,
        typer.Option(
            help="Play only tasks of this kind, by its name or short name. With a Python file of your own "
            "(my_kind.py), one task is generated in each of the ten scenes.",
            show_default="all kinds",
        ),
    ] = "",
    robot: Annotated[
        str,
        typer.Option(
            help="The robot's body: a name ('hthor robots list') or a Python file (my_robot.py).",
            show_default="the task kind's own, usually scout",
        ),
    ] = "",
    robots: Annotated[
        str,
        typer.Option(
            help="Several robots in one trial, each with its own agent: tall:oracle,small:my_agent.py. A body without "
            "an agent gets the one of --agent. Write a comma inside an agent as \\,.",
            show_default=False,
        ),
    ] = "",
    detector: Annotated[
        str,
        typer.Option(
            help="The errors of the robot's detector: own (as its body defines them), ideal, noisy, or rates such as "
            "miss=0.2,false_alarm=0.05,position_sigma=0.03."
        ),
    ] = "own",
    camera: Camera = "own",
    camera_size: CameraSize = "",
    assets: Annotated[
        str,
        typer.Option(
            help="A furniture pack ('hthor assets list') for the robot's camera, rendered in the profile 'nice'.",
            show_default="built-in furniture, in the profile 'fast'",
        ),
    ] = "",
    seed: Annotated[int, typer.Option(help="The same seed gives the same people with the same tasks.")] = 0,
    participants: Annotated[
        int | None,
        typer.Option(
            min=1,
            help="Number of participants; each does ten tasks. With two people in a trial, twice as many are needed.",
            show_default="as many as it takes to do every task once",
        ),
    ] = None,
    house: Annotated[
        list[str] | None,
        typer.Option(
            help="Play only the suite's tasks in this house; repeat the option for several houses. With a house file "
            "of your own (my_house.json), ten tasks are generated in it, as 'hthor tasks make' does, and played.",
            show_default="all houses of the suite",
        ),
    ] = None,
    difficulty: Annotated[
        Literal["easy", "medium", "hard"] | None,
        typer.Option(
            help="Play only tasks of this difficulty. A run of part of a suite is not ranked.", show_default="all"
        ),
    ] = None,
    limit: Annotated[
        int | None,
        typer.Option(
            min=1,
            help="Play only this many of the suite's tasks: always the same ones, spread over its houses and task "
            "kinds. Such a run is not ranked.",
            show_default="all",
        ),
    ] = None,
    jobs: Annotated[
        int | None, typer.Option("--jobs", "-j", min=1, help="Worker processes.", show_default="one per CPU")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="The run's folder; with several agents, the folder that holds one folder per agent.",
            show_default="runs/NAME-SUITE-HASH",
        ),
    ] = None,
    name: Annotated[
        str,
        typer.Option(
            help="A name for the run, shown in tables and used for its folder, runs/NAME. It does not change any "
            "trial.",
            show_default="the agent's",
        ),
    ] = "",
    shard: Annotated[
        str,
        typer.Option(
            metavar="I/N",
            help="Play only share I of N of the run, counted from 1, in a folder of its own; 'hthor merge' joins the "
            "shares.",
            show_default=False,
        ),
    ] = "",
    engine: Annotated[
        str, typer.Option(help="Where trials run: local (processes on this machine) or ray (a Ray cluster).")
    ] = "local",
    address: Annotated[
        str,
        typer.Option(help="With --engine ray: the address of the cluster.", show_default="the cluster of this machine"),
    ] = "",
    trial_limit: Annotated[
        float | None,
        typer.Option(
            min=1.0,
            help="Longest time for one trial [s]. A worker that takes longer is stopped, and its session is played "
            "again.",
            show_default="600; with your own agents, as long as their deadlines allow",
        ),
    ] = None,
    step_limit: Annotated[
        float | None,
        typer.Option(
            min=0.01,
            max=3600.0,
            metavar="SECONDS",
            help="Time limit for each action of your own agents [s]. An agent that takes longer fails the trial. Such "
            "a run is not ranked.",
            show_default="5, plus a reserve of 60 s per trial",
        ),
    ] = None,
    control: Annotated[
        bool,
        typer.Option(
            "--control/--no-control",
            help="Also run the same people and tasks without a robot, unless such a run exists already, and report "
            "the uplift over it.",
        ),
    ] = True,
    design: Design = "paired",
    clock: Annotated[
        Literal["lockstep", "charged", "concurrent"],
        typer.Option(
            help="When agents' decisions take effect. lockstep: at once; the world waits for them. charged: as much "
            "later as the agent took to decide; the person goes on meanwhile. concurrent: the trial runs in real time, "
            "and an action starts when its decision arrives. Only lockstep is reproducible byte for byte.",
        ),
    ] = "lockstep",
    realtime: Annotated[bool, typer.Option("--realtime", hidden=True)] = False,
    isolation: Annotated[
        str,
        typer.Option(
            help="Isolation of your own agents: L1, L2, L3, or auto, the strongest that this machine supports."
        ),
    ] = "auto",
    require_isolation: Annotated[
        str,
        typer.Option(
            help="The weakest acceptable isolation level; exit with code 5 if it is not available.", show_default=False
        ),
    ] = "",
    max_faults: Annotated[
        str,
        typer.Option(
            metavar="N|P%",
            help="Number or share of trials in which an agent may fail; exit with code 3 if there are more.",
        ),
    ] = "0",
    json: Json = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print the result only, no progress.")] = False,
    dry_run: Annotated[
        bool,
        typer.Option("--dry-run", help="Print what would be played, where, and how long it would take; write nothing."),
    ] = False,
    context: typer.Context = None,  # type: ignore[assignment]
) -> None:
    """Evaluate robots that help people with a suite of tasks.

    Running the same command again resumes an interrupted run, and only scores a finished one. The same seed gives the
    same records, byte for byte, with any number of jobs.
    """
    from hthor.eval.comparison import population_matrix
    from hthor.eval.config import human_populations
    from hthor.eval.runner import experiment, progress, run_options
    from hthor.eval.runner import max_faults as max_faults_option
    from hthor.eval.task_check import custom_houses
    from hthor.report.terminal import result_tables

    allowed = max_faults_option.parse_max_faults(max_faults)
    talk = output.console(talk=True)
    if realtime:
        output.say("warning: --realtime is now called --clock charged", talk)
    watcher = partial(progress.make_watcher, talk, quiet=quiet, live=output.live())
    options = run_options.RunOptions(
        agents=tuple(agent or ()),
        robots=robots,
        humans=tuple(humans or ("proxy",)),
        suite=suite,
        kind=kind,
        robot=robot,
        assets=assets,
        detector=detector,
        camera=camera,
        camera_size=camera_size,
        seed=seed,
        participants=participants,
        jobs=jobs,
        out=out,
        shard=shard,
        engine=engine,
        address=address,
        control=control,
        clock="charged" if realtime else clock,
        name=name,
        limit=limit,
        houses=tuple(house or ()),
        difficulty=difficulty or "",
        step_limit=step_limit,
        design=design,
        isolation=isolation,
        require_isolation=require_isolation,
        trial_limit=trial_limit,
        max_faults=max_faults,
        agent_args=tuple(agent_args or ()),
        readable=tuple(readable or ()),
    )
    options = custom_houses.resolve_houses(options, lambda words: None if quiet else output.say(words, talk))
    if dry_run:
        results.show_forecast(options, watcher, context, json)
        return
    paper = talk if json else output.console()
    done: list[FinishedRun] = []
    several = any(word.partition("@")[0] in human_populations.WORDS for word in options.humans)
    single = len(options.agents) <= 1 and len(options.humans) == 1 and not several
    for one in experiment.run_experiment(options, watcher):
        done.append(one)
        if single or not quiet:
            results.show_run(paper if single else talk, one)
    run_results = [one.result for one in done]
    populations = {result.humans.name for result in run_results}
    whole = population_matrix.make_matrix(run_results) if len(populations) > 1 else None
    if whole is not None:
        results.show_populations(paper, whole)
    elif len(done) > 1:
        paper.print(result_tables.comparison_table(run_results))
    if len(done) > 1:
        for one in done:
            whose = f", {one.config.humans.name} people" if whole is not None else ""
            output.say(f"{one.config.label}{whose}: {one.folder}/", paper)
    for note in result_tables.result_notes(run_results):
        output.say(note, paper)
    if json:
        held = tuple(population_matrix.EvaluatedRun(folder=str(one.folder), result=one.result) for one in done)
        output.put_json(population_matrix.Evaluation(runs=held, peoples=whole))
    if any(one.result.counts.faults > allowed(one.result.counts.trials) for one in done):
        raise typer.Exit(_FAULTS_EXIT)
