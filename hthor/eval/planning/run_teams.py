"""The robot teams that the options of `hthor eval` name, and the conditions that they are in a study."""

from hthor.errors import HthorError
from hthor.eval.config import cli_command, study_design
from hthor.eval.config.options import EvalOptions
from hthor.eval.config.task_selection import TaskSelection
from hthor.guest import GuestConfig
from hthor.trials import robot_team
from hthor.trials.robot_team import RobotTeam
from hthor.types import cameras, detector_specs


def choose_teams(options: EvalOptions, tasks: TaskSelection, guests: GuestConfig) -> list[RobotTeam]:
    """The teams that are evaluated, one run each.

    Raises:
        HthorError: when a name is unknown, or the options do not go together.
    """
    return _conditions(options, _named_teams(options, tasks, guests))


def _named_teams(options: EvalOptions, tasks: TaskSelection, guests: GuestConfig) -> list[RobotTeam]:
    """The teams that are evaluated, one run each."""
    detector = detector_specs.canonical_name(options.detector)
    camera = cameras.canonical_name(options.camera, options.camera_size)
    if options.robots:
        if options.robot:
            raise HthorError("--robots names all the robots; leave out --robot.")
        return robot_team.parse_teams(options.robots, options.agent, detector, camera, guests=guests)
    names = (options.robot,) if options.robot else tasks.robots
    if not names:
        raise HthorError(
            f"the task kinds in the suite '{tasks.suite.name}' are made for different robots; name them with --robots, "
            "or choose one kind with --kind."
        )
    robots = [robot_team.load_robot_info(name) for name in names]
    agents = [robot_team.load_agent_info(agent, guests) for agent in options.agent]
    return [robot_team.form_team(robots, [agent] * len(robots), detector, camera) for agent in agents]


def _conditions(options: EvalOptions, teams: list[RobotTeam]) -> list[RobotTeam]:
    """The teams, and in a between-subjects study the condition without a robot, unless it is there or not wanted."""
    if options.design == study_design.PAIRED:
        return teams
    if options.robots:
        raise HthorError("--design between takes one agent for each condition: name them with --agent, not --robots.")
    if options.control and all(team.seats for team in teams):
        return [robot_team.form_team(["scout"], [robot_team.NO_ROBOT_AGENT]), *teams]
    return teams


def agent_word(team: RobotTeam) -> str:
    """The word of the command line for a team's first agent."""
    return cli_command.agent_word(team.listed[0])
