"""A robot that learns: its observations as arrays, its actions as numbers. Begin with `LearnerView`."""

from hthor.agents.skills.learner.learner_view import LearnerView

__all__ = ["LearnerView"]
