"""`hthor eval`; knows what the user types, not how any of it is done."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from hthor.commands.eval import results
from hthor.commands.options import AgentArgs, Camera, CameraSize, Json, Readable
from hthor.console import output

if TYPE_CHECKING:
    from hthor.eval.runner.experiment import ClosableWatcher, FinishedRun

_FAULTS_EXIT = 3


def evaluate(
    agent: Annotated[
        list[str] | None,
        typer.Option(
            help="Who is evaluated: a built-in agent's name ('hthor agents list'); a Python file or module, "
            "my_agent.py, my_agent.py:MyClass, package.module:MyClass; a program, 'cmd:node my_agent.js'; or a served "
            "agent, ws://host:port. Repeat it to compare several.",
            show_default=False,
        ),
    ] = None,
    agent_args: AgentArgs = None,
    readable: Readable = None,
    humans: Annotated[
        list[str] | None,
        typer.Option(
            help="Who the people are ('hthor humans list'): a population, a kind of people or a human model, or a file "
            "of one: pop.npz, my_kind.json, my_human.py; cautious@pop.npz is that kind out of that population. Repeat "
            "it for several, or say 'kinds' (the population and every kind of people) or 'bracket' (the population "
            "between those who take every offer and those who take none).",
            show_default="proxy, the calibrated population",
        ),
    ] = None,
    suite: Annotated[
        str,
        typer.Option(help="The tasks ('hthor tasks list').", show_default="smoke, or the kind's own"),
    ] = "",
    kind: Annotated[
        str,
        typer.Option(
            help="Only tasks of this kind: its name or short name, or a Python file of your own, my_kind.py, of which "
            "a task is drawn in each of the ten scenes.",
            show_default="all kinds",
        ),
    ] = "",
    robot: Annotated[
        str,
        typer.Option(
            help="The robot's body ('hthor robots list'), or a Python file, my_robot.py.",
            show_default="what the kind of task is made for, mostly scout",
        ),
    ] = "",
    robots: Annotated[
        str,
        typer.Option(
            help="Several robots in one trial, each with its own agent: tall:oracle,small:my_agent.py. A body without "
            "an agent gets the one of --agent; a comma within an agent is written \\,.",
            show_default=False,
        ),
    ] = "",
    detector: Annotated[
        str,
        typer.Option(
            help="How the robot's detector errs: own (as its body says), ideal, noisy, or rates such as "
            "miss=0.2,false_alarm=0.05,position_sigma=0.03."
        ),
    ] = "own",
    camera: Camera = "own",
    camera_size: CameraSize = "",
    assets: Annotated[
        str,
        typer.Option(
            help="A furniture pack ('hthor assets list'): the robot's camera then shows it, in the profile nice.",
            show_default="our own furniture, in the profile fast",
        ),
    ] = "",
    seed: Annotated[int, typer.Option(help="Equal seeds give equal people, dealt the same tasks.")] = 0,
    participants: Annotated[
        int | None,
        typer.Option(
            min=1, help="How many people, ten tasks each.", show_default="so many that every task is done once"
        ),
    ] = None,
    house: Annotated[
        list[str] | None,
        typer.Option(
            help="Only the suite's tasks in this house; repeat it for several. Or a house file of your own, "
            "my_house.json: then ten tasks are made in it, as 'hthor tasks make' does, and played.",
            show_default="all of the suite's",
        ),
    ] = None,
    difficulty: Annotated[
        Literal["easy", "medium", "hard"] | None,
        typer.Option(help="Only tasks so hard. A run of a part of a suite is not ranked.", show_default="all"),
    ] = None,
    limit: Annotated[
        int | None,
        typer.Option(
            min=1,
            help="Play only so many of the suite's tasks, always the same ones, spread over its houses and kinds of "
            "task. Such a run is not ranked.",
            show_default="all of them",
        ),
    ] = None,
    jobs: Annotated[
        int | None, typer.Option("--jobs", "-j", min=1, help="Worker processes.", show_default="one a CPU")
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            help="The run's folder; with several agents the folder of their folders.",
            show_default="runs/NAME-SUITE-HASH",
        ),
    ] = None,
    name: Annotated[
        str,
        typer.Option(
            help="A name of your own for the run, in tables and as its folder, runs/NAME; of several agents the folder "
            "of their folders. It changes no trial.",
            show_default="the agent's",
        ),
    ] = "",
    shard: Annotated[
        str,
        typer.Option(
            metavar="I/N",
            help="Play only the I-th of N shares of the run, counted from 1, in a folder of its own; 'hthor merge' "
            "joins them.",
            show_default=False,
        ),
    ] = "",
    engine: Annotated[
        str, typer.Option(help="Where trials are played: local, in processes of this machine, or ray, on a cluster.")
    ] = "local",
    address: Annotated[
        str, typer.Option(help="With --engine ray: the cluster's address.", show_default="the one that is here")
    ] = "",
    trial_limit: Annotated[
        float | None,
        typer.Option(
            min=1.0,
            help="Seconds that a worker may play a trial; one that takes longer is ended, its session played again.",
            show_default="600, and with agents of your own as long as their deadlines allow",
        ),
    ] = None,
    step_limit: Annotated[
        float | None,
        typer.Option(
            min=0.01,
            max=3600.0,
            metavar="SECONDS",
            help="The time that an agent of your own has for each action; one that takes longer has failed in the "
            "trial. Such a run is not ranked.",
            show_default="5, and in each trial 60 more for all actions together",
        ),
    ] = None,
    control: Annotated[
        bool,
        typer.Option(
            "--control/--no-control",
            help="The same people also do the same tasks without a robot, unless such a run lies beside; the result "
            "has the uplift over it.",
        ),
    ] = True,
    realtime: Annotated[
        bool,
        typer.Option(
            "--realtime",
            help="Thinking takes time: an action comes as late as it was decided on, and the person goes on meanwhile. "
            "Such trials do not repeat themselves to the byte.",
        ),
    ] = False,
    isolation: Annotated[
        str, typer.Option(help="How agents of your own are held: L1, L2, L3, or auto, the strongest that there is.")
    ] = "auto",
    require_isolation: Annotated[
        str, typer.Option(help="The least level that will do; with less, exit code 5.", show_default=False)
    ] = "",
    max_faults: Annotated[
        str,
        typer.Option(
            metavar="N|P%",
            help="How many trials an agent may fail in, or what share of them; with more, exit code 3.",
        ),
    ] = "0",
    json: Json = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="No progress, only the result.")] = False,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Only say what would be played, where, and for how long; write nothing.")
    ] = False,
    context: typer.Context = None,  # type: ignore[assignment]
) -> None:
    """Evaluate robots' minds with people over a suite of tasks.

    The same command resumes an interrupted run, and only scores a finished one. The same seed gives the same records,
    byte for byte, with any number of jobs.
    """
    from hthor.eval.comparison import evaluation, population_matrix
    from hthor.eval.config import human_populations
    from hthor.eval.runner import experiment, fault_report, progress, run_options
    from hthor.eval.task_check import custom_houses
    from hthor.report.terminal import result_tables

    allowed = fault_report.parse_max_faults(max_faults)
    talk = output.console(talk=True)

    def watcher(name: str) -> ClosableWatcher:
        if quiet:
            return progress.Silent()
        return progress.Live(talk, name) if output.live() else progress.Plain(talk, name)

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
        realtime=realtime,
        name=name,
        limit=limit,
        houses=tuple(house or ()),
        difficulty=difficulty or "",
        step_limit=step_limit,
        isolation=isolation,
        require_isolation=require_isolation,
        trial_limit=trial_limit,
        max_faults=max_faults,
        agent_args=tuple(agent_args or ()),
        readable=tuple(readable or ()),
    )
    options = custom_houses.resolve(options, lambda words: None if quiet else output.say(words, talk))
    if dry_run:
        from hthor.commands.eval.dry_run import show_forecast

        show_forecast(options, watcher, context, json)
        return
    paper = talk if json else output.console()
    done: list[FinishedRun] = []
    words = options.humans
    single = len(agent or ()) <= 1 and len(words) == 1 and words[0].partition("@")[0] not in human_populations.WORDS
    for one in experiment.run_experiment(options, watcher):
        done.append(one)
        if single or not quiet:
            results.show_run(paper if single else talk, one)
    run_results = [one.result for one in done]
    whole = (
        population_matrix.make_matrix(run_results) if len({result.humans.name for result in run_results}) > 1 else None
    )
    if whole is not None:
        results.show_populations(paper, whole)
    elif len(done) > 1:
        paper.print(result_tables.comparison_table(run_results))
    if len(done) > 1:
        for one in done:
            whose = f", {one.plan.humans.name} people" if whole is not None else ""
            output.say(f"{one.plan.label}{whose}: {one.folder}/", paper)
    for note in result_tables.notes(run_results):
        output.say(note, paper)
    if json:
        held = tuple(evaluation.Evaluated(folder=str(one.folder), result=one.result) for one in done)
        output.put_json(evaluation.Evaluation(runs=held, peoples=whole))
    if any(one.result.counts.faults > allowed(one.result.counts.trials) for one in done):
        raise typer.Exit(_FAULTS_EXIT)
