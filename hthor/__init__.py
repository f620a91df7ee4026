"""hthor: people and robots share a simulated house, and the robot's help is measured."""

__version__ = "0.1.0"
