"""One person's own page, which needs no network and no script: for them to read and to keep."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path

from hthor import jsonio
from hthor.eval.config.human_populations import LIVE
from hthor.eval.records.run_folder import RunFolder
from hthor.report.drawing import render_trial
from hthor.report.html import elements, matplotlib_svg, number_format, style
from hthor.report.html.elements import Piece
from hthor.report.person import own_session, way_map
from hthor.report.person.own_session import OwnMessage, OwnSession, OwnTrial

FOLDER = "people"
"""The folder of a run with the pages and numbers of its people."""
_RULES = """
main{max-width:50rem}
p,ul{max-width:none}
.trial{display:grid;grid-template-columns:minmax(16rem,22rem) 1fr;gap:0 1.6rem;align-items:start;
 border-top:1px solid var(--line);padding-top:.8rem;margin-top:1.4rem;break-inside:avoid}
.trial h3{grid-column:1/-1;margin:.2rem 0 .4rem}
.trial figure{margin:.2rem 0}
.trial svg{border:1px solid var(--line)}
.trial ol{padding-left:1.3rem;margin:.4rem 0}
.trial li{margin:.35rem 0}
.trial li small{display:block;color:var(--soft)}
td b,tbody th{white-space:normal}
@media screen and (max-width:46rem){.trial{grid-template-columns:1fr}}
"""
_ANSWERS = {"accepted": "You confirmed it", "declined": "You declined it", "answered": "You answered it"}


def own_sessions(folder: RunFolder, person: int | None = None) -> tuple[OwnSession, ...]:
    """The sessions of the people at pages in a run, or of one of them, by number; errors as in `RunFolder.records`."""
    trials: dict[int, list[OwnTrial]] = {}
    voided: dict[int, int] = {}
    for record in folder.attempts():
        for human in (one for one in record.spec.humans if one.model == LIVE and record.log.voided):
            voided[human.participant] = voided.get(human.participant, 0) + 1
    for record in folder.records():
        house = render_trial.load_house(folder.path, record)
        for human in (one for one in record.spec.humans if one.model == LIVE):
            trials.setdefault(human.participant, []).append(own_session.own_trial(record, house, human.seat))
    return tuple(
        OwnSession(participant=number, trials=tuple(own), voided=voided.get(number, 0))
        for number, own in sorted(trials.items())
        if person in (None, number)
    )


def write_pages(folder: RunFolder, sections: Mapping[int, str], person: int | None = None) -> dict[int, Path]:
    """Write the page of each person at a page, or of one of them; its path by the person's number.

    Args:
        sections: more to show on each one's page, as HTML, by the person's number.
    """
    found = {}
    for session in own_sessions(folder, person):
        path = folder.path / FOLDER / f"participant-{session.participant}.html"
        jsonio.write(path, render(session, sections.get(session.participant, "")).encode())
        found[session.participant] = path
    return found


def render(session: OwnSession, section: str = "") -> str:
    """The page; the same session gives the same bytes."""
    body = [_head(session), section, "<h2>Your tasks, one by one</h2>", _legend(session)]
    body += [_trial(session, one) for one in session.trials]
    body.append(
        "<footer>Made by hthor from the log of this session. It holds your own way, answers and ratings, and the "
        "messages that were shown to you.</footer>"
    )
    return elements.page("Your session", [part for part in body if part], style.css(_RULES))


def _head(session: OwnSession) -> str:
    trials, done = len(session.trials), sum(one.met for one in session.trials)
    minutes = sum(one.seconds for one in session.trials) / 60.0
    words = [
        f"Thank you for taking part. You did {_count(trials, 'task')} in {minutes:.0f} minutes; {done} of them came to "
        "their end within the time."
    ]
    if session.has_robots:
        words.append(_messages_words(session))
    if session.voided:
        words.append(f"{_count(session.voided, 'attempt')} did not count, and {_was(session.voided)} left out here.")
    rated = [one for one in session.trials if one.rating is not None]
    if rated:
        first, last = rated[0].rating, rated[-1].rating
        words.append(
            f"Your trust in the robot, from 1 to 7, was {first} after the first task and {last} after the last."
        )
    note = (
        "This page only describes what happened. None of it is a test of you: the tasks are made so that some do not "
        "work out in time, and every way of doing them is of use."
    )
    return "\n".join(("<h1>Your session</h1>", elements.paragraphs(words), elements.paragraph(note, "note")))


def _messages_words(session: OwnSession) -> str:
    messages = session.messages
    if not messages:
        return "No message was shown to you."
    told = [(_count(len(messages), "message"), f"{_was(len(messages))} shown to you")]
    counts = {word: sum(one.answer == answer for one in messages) for word, answer in _COUNTED.items()}
    parts = [f"{word} {count}" for word, count in counts.items() if count]
    followed = [one.found_s for one in messages if one.found_s is not None and not one.wrong]
    text = f"{told[0][0]} {told[0][1]}. " + (f"You {number_format.listed(parts)}." if parts else "You answered none.")
    if followed:
        text += f" After {len(followed)} of the confirmed messages you had what it was about, {_range(followed)} later."
    if any(one.wrong for one in messages):
        wrong = sum(bool(one.wrong) for one in messages)
        text += (
            f" {wrong} of the {len(messages)} messages named a wrong place. That was no fault of yours: robots can be "
            "mistaken, and how people deal with it is a part of the study."
        )
    return text


_COUNTED = {"confirmed": "accepted", "declined": "declined", "answered": "answered", "left without an answer": ""}


def _legend(session: OwnSession) -> str:
    text = (
        "Each picture is the house from above with your own way, from the ring to the disc: it darkens with time, with "
        "a dot every ten seconds."
    )
    if session.messages:
        text += " Numbers are the places that messages named: strong where you confirmed the message, else pale."
    return elements.paragraph(text)


def _trial(session: OwnSession, one: OwnTrial) -> str:
    name = f"trial-{one.number}"
    drawing = matplotlib_svg.to_svg(way_map.figure(one), name, f"The way in task {one.number}, from above.")
    end = f"Finished after {one.seconds:.0f} s." if one.met else f"Time was over after {one.seconds:.0f} s."
    parts = [elements.paragraph(end)]
    if one.messages:
        parts.append(f"<ol>{''.join(f'<li>{_message(message)}</li>' for message in one.messages)}</ol>")
    elif session.has_robots:
        parts.append(elements.paragraph("No message was shown to you."))
    parts += [elements.paragraph(words) for words in one.robots]
    if one.rating is not None:
        parts.append(elements.paragraph(f"Trust in the robot afterwards: {one.rating} of 7."))
    title = f"{one.number}. {one.instruction}"
    told = f"<div>{''.join(parts)}</div>"
    return f'<div class="trial"><h3>{escape(title)}</h3>{elements.figure(drawing, "", "map")}{told}</div>'


def _message(message: OwnMessage) -> str:
    """A message in words: what it said, what the person did, and what came of it."""
    done = _ANSWERS.get(message.answer)
    words = f"{done} after {message.answer_s:.0f} s." if done else "You left it without an answer."
    if message.wrong:
        words += " The place was not the right one."
    elif message.found_s is not None:
        words += f" {message.found_s:.0f} s later you had what it was about."
    who = own_session.plain(message.sender)
    said = f"{who.capitalize()}, after {message.shown_s:.0f} s: “{message.text}”"
    return f"{escape(said)}<small>{escape(words)}</small>"


def table(head: Sequence[str], rows: Sequence[Sequence[Piece]], caption: str) -> str:
    """A table of words for a section of a person's page."""
    return elements.table(head, rows, caption, words=range(len(head)))


def _count(number: int, word: str, plural: str = "") -> str:
    return f"{number} {word if number == 1 else plural or f'{word}s'}"


def _was(number: int) -> str:
    return "was" if number == 1 else "were"


def _range(seconds: Sequence[float]) -> str:
    low, high = min(seconds), max(seconds)
    return f"{low:.0f} s" if round(low) == round(high) else f"{low:.0f} to {high:.0f} s"
