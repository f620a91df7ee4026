"""The options of `hthor eval`, each once: name, type, default, range and help.

The command line, its help, docs/cli.md, the signature of `hthor.evaluate` and the checks of all values are made from
`EvalOptions`; `hthor.eval.planning.resolve` turns it into runs. This file imports nothing large: every command's help
is printed with it.
"""

from pathlib import Path
from typing import Annotated, Literal

from msgspec import Struct

from hthor.eval.config.option import Option


class EvalOptions(Struct, frozen=True, kw_only=True):
    """The options of `hthor eval`, in the order of its help."""

    agent: Annotated[
        tuple[str, ...],
        Option(
            help="The agent to evaluate: the name of a built-in agent ('hthor agents list'); a Python file or module "
            "(my_agent.py, my_agent.py:MyClass, package.module:MyClass); a program ('cmd:node my_agent.js'); or a "
            "served agent (ws://host:port). Repeat the option to compare several agents.",
        ),
    ] = ()
    agent_args: Annotated[
        tuple[str, ...],
        Option(
            placeholder="KEY=VALUE",
            help="An argument for your own agents, passed to the constructor of the class, or to a program as "
            "--KEY=VALUE. If it names a file, the agent may read it. It is part of the agent's identity. Repeat the "
            "option for several.",
        ),
    ] = ()
    readable: Annotated[
        tuple[Path, ...],
        Option(
            placeholder="PATH",
            help="A file or folder outside the agent's own folder that the agent may read, such as weights. It is part "
            "of the agent's identity. Repeat the option for several.",
        ),
    ] = ()
    humans: Annotated[
        tuple[str, ...],
        Option(
            help="The people ('hthor humans list'): a population, a kind of people or a human model, by name or as a "
            "file (pop.npz, my_kind.json, my_human.py). cautious@pop.npz is the kind 'cautious' drawn from pop.npz. "
            "A comma joins the people of one trial: proxy,proxy. Repeat the option to run several populations one "
            "after the other; 'kinds' means the population and every kind of people; 'bracket' means the population "
            "and two bounds: people who accept every message and people who accept none.",
            default="proxy, the calibrated population",
        ),
    ] = ("proxy",)
    suite: Annotated[
        str,
        Option(help="The suite of tasks ('hthor tasks list'): a name or a file.", default="smoke, or the kind's own"),
    ] = ""
    kind: Annotated[
        str,
        Option(
            help="Play only tasks of this kind, by its name or short name. With a Python file of your own "
            "(my_kind.py), one task is generated in each of the ten scenes.",
            default="all kinds",
        ),
    ] = ""
    robot: Annotated[
        str,
        Option(
            help="The robot's body: a name ('hthor robots list') or a Python file (my_robot.py).",
            default="the task kind's own, usually scout",
        ),
    ] = ""
    robots: Annotated[
        str,
        Option(
            help="Several robots in one trial, each with its own agent: tall:oracle,small:my_agent.py. A body without "
            "an agent gets the one of --agent. Write a comma inside an agent as \\,.",
        ),
    ] = ""
    detector: Annotated[
        str,
        Option(
            help="The errors of the robot's detector: own (as its body defines them), ideal, noisy, or rates such as "
            "miss=0.2,false_alarm=0.05,position_sigma=0.03."
        ),
    ] = "own"
    camera: Annotated[
        str,
        Option(
            help="The robot's camera: own (as its body defines it), square, thor, habitat or realsense; docs/robots.md "
            "lists their fields of view and sizes. The camera does not change what the robot detects."
        ),
    ] = "own"
    camera_size: Annotated[
        str,
        Option(
            placeholder="WxH",
            help="Size of the camera's images [pixels], such as 320x240. Pixels are square, so an image of another "
            "shape than the field of view is cropped to its middle.",
            default="the camera's own",
        ),
    ] = ""
    assets: Annotated[
        str,
        Option(
            help="A furniture pack ('hthor assets list') for the robot's camera, rendered in the profile 'nice'.",
            default="built-in furniture, in the profile 'fast'",
        ),
    ] = ""
    seed: Annotated[int, Option(least=0, help="The same seed gives the same people with the same tasks.")] = 0
    participants: Annotated[
        int | None,
        Option(
            least=1,
            help="Number of participants; each does ten tasks. With two people in a trial, twice as many are needed.",
            default="as many as it takes to do every task once",
        ),
    ] = None
    house: Annotated[
        tuple[str, ...],
        Option(
            help="Play only the suite's tasks in this house; repeat the option for several houses. With a house file "
            "of your own (my_house.json), ten tasks are generated in it, as 'hthor tasks make' does, and played.",
            default="all houses of the suite",
        ),
    ] = ()
    difficulty: Annotated[
        Literal["easy", "medium", "hard"] | None,
        Option(help="Play only tasks of this difficulty. A run of part of a suite is not ranked.", default="all"),
    ] = None
    limit: Annotated[
        int | None,
        Option(
            least=1,
            help="Play only this many of the suite's tasks: always the same ones, spread over its houses and task "
            "kinds. Such a run is not ranked.",
            default="all",
        ),
    ] = None
    jobs: Annotated[int | None, Option(short="j", least=1, help="Worker processes.", default="one per CPU")] = None
    out: Annotated[
        Path | None,
        Option(
            help="The run's folder; with several agents, the folder that holds one folder per agent.",
            default="runs/NAME-SUITE-HASH",
        ),
    ] = None
    name: Annotated[
        str,
        Option(
            help="A name for the run, shown in tables and used for its folder, runs/NAME. It does not change any "
            "trial.",
            default="the agent's",
        ),
    ] = ""
    shard: Annotated[
        str,
        Option(
            placeholder="I/N",
            help="Play only share I of N of the run, counted from 1, in a folder of its own; 'hthor merge' joins the "
            "shares.",
        ),
    ] = ""
    engine: Annotated[
        str, Option(kept=True, help="Where trials run: local (processes on this machine) or ray (a Ray cluster).")
    ] = "local"
    address: Annotated[
        str,
        Option(kept=True, help="With --engine ray: the address of the cluster.", default="the cluster of this machine"),
    ] = ""
    trial_limit: Annotated[
        float | None,
        Option(
            kept=True,
            least=1.0,
            help="Longest time for one trial [s]. A worker that takes longer is stopped, and its session is played "
            "again.",
            default="600; with your own agents, as long as their deadlines allow",
        ),
    ] = None
    step_limit: Annotated[
        float | None,
        Option(
            least=0.01,
            most=3600.0,
            placeholder="SECONDS",
            help="Time limit for each action of your own agents [s]. An agent that takes longer fails the trial. Such "
            "a run is not ranked.",
            default="5, plus a reserve of 60 s per trial",
        ),
    ] = None
    control: Annotated[
        bool,
        Option(
            negatable=True,
            help="Also run the same people and tasks without a robot, unless such a run exists already, and report "
            "the uplift over it.",
        ),
    ] = True
    design: Annotated[
        Literal["paired", "between"],
        Option(
            help="Who meets which robot. paired: every robot meets the same people, each time as if it were the first. "
            "between: everybody meets one robot; the people are divided at random and evenly among the agents and, "
            "unless --no-control is given, no robot. --participants is then the number of people in all groups."
        ),
    ] = "paired"
    clock: Annotated[
        Literal["lockstep", "charged", "concurrent"],
        Option(
            help="When agents' decisions take effect. lockstep: at once; the world waits for them. charged: as much "
            "later as the agent took to decide; the person goes on meanwhile. concurrent: the trial runs in real time, "
            "and an action starts when its decision arrives. Only lockstep is reproducible byte for byte.",
        ),
    ] = "lockstep"
    isolation: Annotated[
        str,
        Option(
            kept=True,
            help="Isolation of your own agents: L1, L2, L3, or auto, the strongest that this machine supports.",
        ),
    ] = "auto"
    require_isolation: Annotated[
        str,
        Option(kept=True, help="The weakest acceptable isolation level; exit with code 5 if it is not available."),
    ] = ""
    max_faults: Annotated[
        str | int,
        Option(
            kept=True,
            placeholder="N|P%",
            help="Number or share of trials in which an agent may fail; exit with code 3 if there are more.",
        ),
    ] = "0"
