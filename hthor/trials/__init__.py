"""Trials without a run: sessions of tasks, the people and robots in them, their worlds, and what runs them.

from hthor.trials import TrialRunner, make_sessions

runner = TrialRunner()
for session in make_sessions("smoke", agent="frontier"):
    for played in runner.play(session):
        print(played.spec.task.id, played.log.met)
"""

from hthor.trials.human_team import HumanTeam, find_team
from hthor.trials.participants import Participants
from hthor.trials.robot_team import RobotTeam, form_team
from hthor.trials.sessions import Session, make_session, make_sessions
from hthor.trials.sources import Sources, make_sources
from hthor.trials.trial_runner import PlayedTrial, TrialRunner
from hthor.trials.worlds import Worlds

__all__ = [
    "HumanTeam",
    "Participants",
    "PlayedTrial",
    "RobotTeam",
    "Session",
    "Sources",
    "TrialRunner",
    "Worlds",
    "find_team",
    "form_team",
    "make_session",
    "make_sessions",
    "make_sources",
]
