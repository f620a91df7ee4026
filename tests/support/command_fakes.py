"""The command line in a process of its own, with a fake suite, fake agents and a fake umpire: PLAYER WORDS..."""

from __future__ import annotations

import sys


def perform(name: str, sources: object = None):
    """A player of `eval_fakes` by its name; what follows a colon is its argument."""
    import eval_fakes

    player, _, word = name.partition(":")
    made = getattr(eval_fakes, player)
    return made(float(word) if word.replace(".", "").isdigit() else word) if word else made()


def main(name: str) -> None:
    """Run the command with the player of this name."""
    import functools

    import command_fakes
    import eval_fakes

    from hthor import cli, tasks
    from hthor.eval.runner import engines, session_runner
    from hthor.trials import robot_team

    real, introduce = tasks.load_suite, robot_team.load_agent_info
    tasks.load_suite = lambda word: eval_fakes.suite(20) if word == "fake" else real(word)
    session_runner.make_runner = functools.partial(command_fakes.perform, name)
    robot_team.load_agent_info = lambda word, *_: (
        eval_fakes.character(word) if word in ("helper", "clumsy") else introduce(word)
    )
    if not name.startswith("slow"):
        engines.find_engine = lambda *_, **__: eval_fakes.Here()  # saves starting other processes
    cli.main()


if __name__ == "__main__":
    player = sys.argv.pop(1)
    main(player)
