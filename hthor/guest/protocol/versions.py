"""The version of the wire protocol, and what to tell an agent that uses another one (docs/wire.md#changes)."""

VERSION = 2
"""Version of this protocol; guests with another version are refused."""
UNSTATED = 1
"""Version of a guest that does not say which one it uses: the first version did not ask for it."""
_CHANGES = {
    2: (
        'the status "confirmed" of a receipt is now "accepted", and "answered" is new',
        "`teammates` may be people (seats human, human2, ...)",
        "the `inbox` has messages from people, with `to`, `question` and `answers`, and `image` is nil if there is no "
        "picture",
        "a pose may have `head`",
        "the motion `drive` and the fields `to`, `question` and `answers` of `send` are new",
    )
}
"""For each version, what a guest of the version before has to change or may ignore."""


def describe_mismatch(version: int, *, served: bool = False) -> str:
    """What to change about an agent of this version, in words that follow its name; empty if it can play.

    Args:
        served: whether another hthor may speak for the agent, on a server.
    """
    if version == VERSION:
        return ""
    if version > VERSION:
        return (
            f"it uses version {version} of the protocol, but this hthor only knows versions up to {VERSION}: update "
            "hthor here, or use a version of the agent that was made for this one."
        )
    changes = "; ".join(change for number, some in _CHANGES.items() if number > version for change in some)
    unstated = " (as every agent does whose `ready` has no `wire`)" if version == UNSTATED else ""
    update = " If `hthor agent serve` serves it, only hthor has to be updated there." if served else ""
    return (
        f"it uses version {version} of the protocol{unstated}, but this hthor uses {VERSION}. What has changed: "
        f"{changes}. "
        f'Adapt the agent and send "wire": {VERSION} in its `ready`; see docs/wire.md#changes.{update}'
    )
