"""What a participant is saying, or about to press: it takes effect when it is done."""

from hthor.types import Message, Reply, Send

PREPARE_S = 1.35
"""[s] Time to think before a question is asked or answered. Source: mental preparation in the keystroke-level model
[25]."""
PRESS_S = 0.2
"""[s] Time to press a button. Source: the keystroke of an average typist in the keystroke-level model [25]."""
WORDS_PER_S = 2.5
"""[words/s] Speaking rate. Source: 150 to 160 words a minute in English conversation (m), fewer in short turns [26]."""


class Speech:
    """One utterance at a time: a question or an answer that is spoken, or a yes or no that is pressed.

    ``now`` is the utterance, None while the participant says nothing.
    """

    def __init__(self, tick_s: float) -> None:
        self.tick_s = tick_s
        self.now: Send | Reply | None = None
        self._until = 0.0

    def begin(self, tick: int, say: Send | Reply) -> float:
        """Begin to say something; returns how long it takes [s]."""
        seconds = PREPARE_S + (PRESS_S if isinstance(say, Reply) else len(say.text.split()) / WORDS_PER_S)
        self.now, self._until = say, tick + seconds / self.tick_s
        return seconds

    def finish(self, tick: int, inbox: tuple[Message, ...]) -> Send | Reply | None:
        """The utterance if it is done now; an answer to a question that is not on display any more is dropped."""
        if self.now is None or tick < self._until:
            return None
        say, self.now = self.now, None
        answered = say.message if isinstance(say, Reply) else say.answers
        return say if answered is None or any(message.id == answered for message in inbox) else None
