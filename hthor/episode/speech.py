"""What is said in a trial, on its way to the mailbox."""

from collections.abc import Sequence

import msgspec

from hthor.comms import claims
from hthor.comms.mailbox import Mailbox
from hthor.episode.trial_world import TrialWorld
from hthor.types import Reply, Send, is_person
from hthor.types.events import Event, Sent


def say(world: TrialWorld, mailbox: Mailbox, seat: str, words: Send | Reply) -> Sequence[Event]:
    """Deliver a message or a reply; a robot's message gets its picture, and its event how far its claim is off."""
    if isinstance(words, Reply):
        return mailbox.reply(world.tick, seat, words)
    image = None if is_person(seat) else world.frame(seat)
    return [_with_claim_error(event, words, world) for event in mailbox.send(world.tick, seat, words, image)]


def _with_claim_error(event: Event, send: Send, world: TrialWorld) -> Event:
    if not isinstance(event, Sent):
        return event
    off = claims.claim_error(send.object, event.position, world.snapshot(), world.house)
    return msgspec.structs.replace(event, off=off)
