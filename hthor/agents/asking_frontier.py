"""The frontier robot, which also asks whether its suggestions were accepted, and later whether they helped."""

from hthor.agents import frontier


class Agent(frontier.Agent):
    """Does what `hthor.agents.frontier` does, and asks people what became of its suggestions.

    It asks whether a suggestion was accepted if nothing came back for 12 s after it was shown, and whether the object
    was found 25 s after it was accepted. After a no it repeats the suggestion, after a yes it stays quiet.
    """

    asks = True
