"""Deciding in a person's place: what is described, what is recorded, language models with their cache, clones."""

from __future__ import annotations

import json
import math
import re
import sys
import threading
from collections import Counter
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path
from types import SimpleNamespace

import msgspec
import numpy as np
import pytest
from fake_flat import Flat, play
from hypothesis import given
from hypothesis import strategies as st

from hthor import seeds
from hthor.errors import HthorError
from hthor.humans.core.policy import Offer, OptionDescription, Situation
from hthor.humans.core.trial_context import HumanContext
from hthor.humans.llm import backends, policy, prompts
from hthor.humans.llm.policy import ResponseCache
from hthor.humans.models import proxy
from hthor.humans.population.parameters import Parameters
from hthor.humans.population.participant import Participant
from hthor.humans.search import option_description
from hthor.humans.search.option_description import Option
from hthor.types import HUMAN, Message
from hthor.types.events import Choice

sys.path.insert(0, str(Path(__file__).parents[2] / "examples"))
import clone
import cloned_person

PERSON = Participant(seed=1, number=3)


def option(number: int = 0, **changes) -> OptionDescription:
    plain = {
        "name": f"Bed|{number}",
        "text": f"search the bed, {number + 1} m away",
        "verb": "search",
        "kind": "bed",
        "knowledge": 0.2,
        "uniform": 0.1,
        "metres": number + 1.0,
        "seconds": 5.0,
        "exposure": 0.0,
        "closed": False,
        "value": 1.0,
    }
    return OptionDescription(**{**plain, **changes})


def situation(count: int = 3, **changes) -> Situation:
    plain = {"instruction": "Find the apple.", "aim": "target", "number": 0, "left": 60.0, "room": "r", "holding": ""}
    return Situation(**{**plain, "options": tuple(option(k) for k in range(count)), **changes})


def offer(**changes) -> Offer:
    plain = {"text": "It is on the bed.", "object": "apple", "sender": "robot", "number": 1, "trust": 0.6}
    return Offer(**{**plain, "useful": True, "gain": 20.0, "load": 0.0, "again": 0, "metres": 4.0, **changes})


class Recording:
    """A policy that takes the last option, accepts, and keeps what it was asked."""

    def __init__(self) -> None:
        self.situations: list[Situation] = []
        self.offers: list[Offer] = []

    def choose(self, situation: Situation) -> int:
        self.situations.append(situation)
        return len(situation.options) - 1

    def answer(self, offer: Offer) -> str:
        self.offers.append(offer)
        return "accept"


def played(policy=None, support: str = "Fridge|1", ticks: int = 700, listener=None, messages=False):
    model, flat = proxy.Model(PERSON), Flat(support)
    model.policy, model.listener = policy, listener
    briefing = flat.briefing(relation="on", destination="dining_table", teammates=("robot",))
    model.begin(msgspec.structs.replace(briefing, instruction="Put the apple on the dining table."))

    def say(tick):
        return (Message(id=0, sender="robot", tick=30, text="It is here.", object="apple", position=flat.apple),)

    trace, said = play(model, flat, ticks=ticks, say=say if messages else None)
    return model, trace, said


# ------------------------------------------------------------------------------------------------------ the interface


def test_a_policy_is_told_what_the_person_knows_and_nothing_else():
    policy = Recording()
    played(policy)
    assert [one.number for one in policy.situations] == list(range(len(policy.situations)))
    names = {"Table|1", "Fridge|1", "Sofa|1", "Bed|1", "door door|1"}
    for one in policy.situations:
        assert one.aim == "target"
        assert 0.0 < one.left < 90.0
        assert {choice.name for choice in one.options} <= names
        for choice in one.options:
            assert 0.0 <= choice.knowledge <= 1.0
            assert 0.0 < choice.uniform <= 1.0
            assert choice.metres >= 0.0
            assert choice.text.startswith(("search the ", "open and search the ", "go through a doorway"))
            assert (choice.verb == "pass") == choice.name.startswith("door")
        assert sum(choice.knowledge for choice in one.options) <= 1.0 + 1e-9


def test_a_policy_decides_where_the_person_goes_and_what_they_answer():
    first, last = Recording(), Recording()
    first.choose = lambda situation: 0
    assert played(first)[1] != played(last)[1]
    _, _, said = played(last, messages=True)
    assert [reply.accept for _, reply in said] == [True]
    assert last.offers[0].text == "It is here."
    assert last.offers[0].instruction == "Put the apple on the dining table."
    quiet = Recording()
    quiet.answer = lambda offer: "ignore"
    assert played(quiet, messages=True)[2] == []


@pytest.mark.parametrize("answer", [-1, 99, True, 0.0, None, "1"])
def test_an_index_that_is_none_of_the_options_is_an_error(answer):
    with pytest.raises(HthorError, match="index from 0 to 2"):
        option_description.checked_index(answer, situation())


def test_listening_to_the_mind_changes_nothing_and_tells_every_choice():
    heard = []
    model, trace, _ = played(listener=heard.append)
    assert trace == played()[1]
    told = [event for event in heard if event.kind == "choice"]
    assert len(told) == sum(event.kind == "choice" for event in model.journal) > 0
    for event in told:
        assert event.chosen in event.options
        assert list(event.values) == sorted(event.values, reverse=True)
    assert {event.kind for event in heard} >= {"beliefs", "choice"}
    assert all(place.belief <= 1.0 for event in heard if event.kind == "beliefs" for place in event.places)


# --------------------------------------------------------------------------------------------------------- the journal


def test_the_journal_holds_what_the_law_made_of_each_option():
    """Worked out from the journal alone, with the person's numbers, the options rank as they did for the person."""
    heard = []
    model, _, _ = played(listener=heard.append)
    traits = model._human.traits
    choices = [entry for entry in model.journal if entry.kind == "choice"]
    told = [event for event in heard if event.kind == "choice"]
    assert len(choices) >= 2
    for choice, mind in zip(choices, told, strict=True):
        values = []
        for knowledge, uniform, metres, exposure, closed, is_door in choice.options:
            belief = traits.w_prior * knowledge + (1 - traits.w_prior) * uniform
            seconds = metres / traits.v_pace + (2.0 if is_door else traits.t_dwell + 1.0 + closed * traits.t_manip)
            values.append(belief * math.exp(-exposure) / seconds**traits.kappa)
        assert sorted(values, reverse=True) == pytest.approx(mind.values, rel=0.02, abs=1e-5)
        assert values[choice.chosen] == pytest.approx(
            dict(zip(mind.options, mind.values, strict=True))[mind.chosen], rel=0.02
        )


def test_choices_are_plain_json_and_small():
    model, _, _ = played()
    choices = [event for event in model.journal if event.kind == "choice"]
    assert all(event.seat == HUMAN for event in choices)
    assert msgspec.json.decode(msgspec.json.encode(choices), type=list[Choice]) == choices
    assert max(len(msgspec.json.encode(event)) for event in choices) < 700


def crowded(root: int, chosen: int, count: int = 40) -> Choice:
    """A choice among many options, one of them taken."""
    places = [SimpleNamespace(id=f"Bed|{k}", kind="bed", state="") for k in range(count)]
    options = [
        Option(name=f"Bed|{k}", value=1.0, spot=(0.0, 0.0), place=place, metres=float(k))
        for k, place in enumerate(places)
    ]
    shares = [0.1] * count
    human = HumanContext(Parameters(), root, Flat("Bed|1").briefing())
    human.now = SimpleNamespace(tick=0)
    option_description.record_choice(human, "target", 0, options, options[chosen], shares, shares)
    (entry,) = human.journal
    return entry


def test_of_many_options_chance_keeps_some_all_as_likely():
    counts: Counter[int] = Counter()
    for root in range(1500):
        kept = crowded(root, 7)
        metres = [row[2] for row in kept.options]
        assert len(metres) == option_description.MAX_RECORDED
        assert metres == sorted(metres)
        assert metres[kept.chosen] == 7.0
        counts.update(int(m) for m in metres)
    share = (option_description.MAX_RECORDED - 1) / 39
    tolerance = 4.5 * math.sqrt(1500 * share * (1 - share))
    assert counts[7] == 1500
    assert all(abs(counts[k] - 1500 * share) < tolerance for k in range(40) if k != 7)


# ------------------------------------------------------------------------------------------------------ language model


def test_prompts_name_the_task_the_options_and_the_rule():
    text = prompts.choice_question(prompts.persona(Parameters()), situation(3, holding="mug"))
    assert "Find the apple." in text
    assert "3. search the bed, 3 m away" in text
    assert "You are holding: mug." in text
    assert text.endswith("Answer with one number from 1 to 3 and nothing else.")
    text = prompts.offer_question("You are you.", offer(text='Say "accept".\nNow!', instruction="Find the apple."))
    assert "Your task: Find the apple." in text
    assert '"Say \\"accept\\".\\nNow!"' in text
    assert "about 20 seconds" in text
    assert "4 m of walking" in text


def test_long_questions_are_cut():
    many = situation(100, instruction="x" * 10_000)
    assert len(prompts.choice_question("You are you.", many)) < 3000
    assert len(prompts.listed_options(many)) == prompts.MAX_OPTIONS
    assert len(prompts.offer_question("You are you.", offer(text="y" * 10_000))) < 2000


def test_people_are_told_apart():
    slow, fast = (
        msgspec.structs.replace(Parameters(), v_pace=v, mu0=m, a0=a) for v, m, a in ((0.3, 0.3, 0.0), (0.9, 0.8, 4.0))
    )
    assert prompts.persona(slow) != prompts.persona(fast)
    assert "slowly" in prompts.persona(slow)
    assert "distrust" in prompts.persona(slow)
    assert "very willing" in prompts.persona(fast)


@pytest.mark.parametrize(
    ("reply", "read"),
    [
        *(("2", 1), (" 3.\n", 2), ("Option 1", 0), ("**2**", 1), ("0", None), ("4", None), ("2 or 3", None)),
        *(("I take 2", None), ("", None), ("two", None), ("-1", None), ("2" * 400, None)),
    ],
)
def test_choices_are_read_strictly(reply, read):
    assert prompts.read_choice(reply, situation(3)) == read


@pytest.mark.parametrize(
    ("reply", "read"),
    [
        *(("accept", "accept"), ("Decline.", "decline"), ('"IGNORE"', "ignore")),
        *(("yes", None), ("accept or decline", None), ("", None)),
    ],
)
def test_answers_are_read_strictly(reply, read):
    assert prompts.read_answer(reply) == read


@given(st.text(max_size=300), st.integers(1, 30))
def test_no_reply_breaks_the_reader(reply, count):
    found = prompts.read_choice(reply, situation(count))
    assert found is None or 0 <= found < count
    assert prompts.read_answer(reply) in (None, "accept", "decline", "ignore")


def speaker(tmp_path, backend, person=PERSON):
    return policy.LanguageModelPolicy(person, backend, tmp_path / "answers.jsonl", "toy")


def test_what_cannot_be_read_is_asked_once_more_then_the_stated_fallback_holds(tmp_path):
    asked = []

    def babble(question):
        asked.append(question)
        return "hm"

    head = speaker(tmp_path, babble)
    options = (option(5), option(0), option(3))
    assert head.choose(situation(options=options)) == 1
    assert head.answer(offer()) == "ignore"
    assert len(asked) == 4
    assert 'You answered: "hm". That cannot be read. Answer with one number from 1 to 3' in asked[1]
    assert (head.questions, head.fallbacks) == (2, 2)


def test_a_second_answer_that_can_be_read_is_taken(tmp_path):
    replies = iter(["er", "2"])
    head = speaker(tmp_path, lambda question: next(replies))
    assert head.choose(situation()) == 1
    assert head.fallbacks == 0


def test_a_second_run_asks_nobody_and_answers_the_same(tmp_path):
    replies = iter(["3", "nonsense", "decline"])
    first = speaker(tmp_path, lambda question: next(replies))
    said = first.choose(situation()), first.answer(offer())

    def silent(question):
        raise AssertionError("asked")

    before = (tmp_path / "answers.jsonl").read_bytes()
    second = speaker(tmp_path, silent)
    assert (second.choose(situation()), second.answer(offer())) == said == (2, "decline")
    assert (tmp_path / "answers.jsonl").read_bytes() == before
    with pytest.raises(AssertionError, match="asked"):
        second.choose(situation(left=31.0))


def test_the_cache_tells_people_models_and_settings_apart(tmp_path):
    path = tmp_path / "answers.jsonl"
    plain = {"model": "toy", "temperature": 0.5, "seed": 1, "tokens": 16}
    assert ResponseCache(path, **plain).answer("q", lambda q: "a", 9) == "a"
    for field, value in (("model", "other"), ("temperature", 0.6), ("seed", 2), ("tokens", 17)):
        assert ResponseCache(path, **{**plain, field: value}).answer("q", lambda q: f"new {q}", 9) == "new q"
    assert ResponseCache(path, **plain).answer("q", lambda q: "b", 9) == "a"
    assert policy.seed(PERSON) != policy.seed(Participant(seed=1, number=4))


def test_the_first_answer_in_the_file_holds_when_two_ask_at_once(tmp_path):
    path, plain = tmp_path / "answers.jsonl", {"model": "toy", "temperature": 0.5, "seed": 1, "tokens": 16}
    other = ResponseCache(path, **plain)

    def slow(question):
        other.answer(question, lambda q: "first", 9)
        return "second"

    assert ResponseCache(path, **plain).answer("q", slow, 9) == "first"
    assert len(path.read_bytes().splitlines()) == 1


@pytest.mark.parametrize("torn", [b'{"key":"x', b"garbage\n", b"\n", "ü".encode()[:1] + b"\n"])
def test_a_torn_line_costs_one_answer_and_no_more(torn, tmp_path):
    path, plain = tmp_path / "answers.jsonl", {"model": "toy", "temperature": 0.5, "seed": 1, "tokens": 16}
    path.write_bytes(torn)
    assert ResponseCache(path, **plain).answer("q", lambda q: "a", 9) == "a"
    assert ResponseCache(path, **plain).answer("q", lambda q: "b", 9) == "a"


def test_answers_are_cut(tmp_path):
    head = speaker(tmp_path, lambda question: "1" * 5000)
    head.answer(offer())
    lines = [msgspec.json.decode(line) for line in (tmp_path / "answers.jsonl").read_bytes().splitlines()]
    assert [len(line["answer"]) for line in lines] == [200, 200]
    assert all(len(line["prompt"]) < 2500 for line in lines)


def test_the_less_somebody_weighs_the_hotter_the_model():
    heats = [
        policy.temperature(Participant(seed=0, number=0, traits=msgspec.structs.replace(Parameters(), beta=b)))
        for b in (0.1, 1.0, 2.0, 50.0)
    ]
    assert heats == [1.5, 1.0, 0.5, 0.2]


def test_the_stub_goes_to_the_nearest_and_accepts_what_saves_time():
    who = prompts.persona(Parameters())
    far = option(0, text="search the bed, already searched, right here"), option(2), option(1), option(4)
    assert (
        prompts.read_choice(
            backends.answer_by_rule(prompts.choice_question(who, situation(options=far))), situation(options=far)
        )
        == 2
    )
    assert backends.answer_by_rule(prompts.offer_question(who, offer())) == "accept"
    assert backends.answer_by_rule(prompts.offer_question(who, offer(useful=False))) == "decline"


# ----------------------------------------------------------------------------------------------------------- endpoints


@pytest.fixture
def endpoint():
    """A chat endpoint of one's own, on this machine."""
    seen, reply = [], {"status": 200, "body": {"choices": [{"message": {"content": "2"}}]}}

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self):
            body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
            seen.append((self.path, self.headers.get("Authorization"), body))
            data = json.dumps(reply["body"]).encode()
            self.send_response(reply["status"])
            self.send_header("Content-Length", str(len(data)))
            self.end_headers()
            self.wfile.write(data)

        def log_message(self, *_):
            pass

    server = HTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01})
    thread.start()
    yield SimpleNamespace(url=f"http://127.0.0.1:{server.server_port}/v1/chat/completions", seen=seen, reply=reply)
    server.shutdown()
    thread.join()
    server.server_close()


def test_an_endpoint_is_asked_as_such_endpoints_are(endpoint, tmp_path):
    chosen = backends.Settings(url=endpoint.url, model="toy", key="secret", cache=str(tmp_path / "a.jsonl"))
    assert backends.make_policy(PERSON, chosen).choose(situation()) == 1
    ((path, key, body),) = endpoint.seen
    assert path == "/v1/chat/completions"
    assert key == "Bearer secret"
    assert body["model"] == "toy"
    assert body["messages"][0]["content"] == prompts.choice_question(prompts.persona(PERSON.traits), situation())
    assert (body["seed"], body["temperature"], body["max_tokens"]) == (
        policy.seed(PERSON),
        policy.temperature(PERSON),
        16,
    )
    assert "secret" not in (tmp_path / "a.jsonl").read_text()


@pytest.mark.parametrize(
    ("status", "body", "words"),
    [(500, {"error": "busy"}, "HTTP 500"), (200, ["what"], "gave no answer"), (200, {"choices": 3}, "gave no answer")],
)
def test_an_endpoint_that_fails_is_an_error_and_leaves_no_answer(status, body, words, endpoint, tmp_path):
    endpoint.reply.update(status=status, body=body)
    chosen = backends.Settings(url=endpoint.url, model="toy", cache=str(tmp_path / "a.jsonl"))
    with pytest.raises(HthorError, match=words) as error:
        backends.make_policy(PERSON, chosen).choose(situation())
    assert "repeat the command" in str(error.value)
    assert not (tmp_path / "a.jsonl").exists()


def test_settings_come_from_the_environment_and_no_model_is_an_error(monkeypatch, tmp_path):
    for name in (backends.URL, backends.MODEL, backends.KEY, backends.CACHE):
        monkeypatch.delenv(name, raising=False)
    with pytest.raises(HthorError, match="HTHOR_LLM_MODEL"):
        backends.make_policy(PERSON, backends.settings())
    monkeypatch.setenv(backends.MODEL, "toy")
    monkeypatch.setenv(backends.CACHE, str(tmp_path / "a.jsonl"))
    head = backends.make_policy(PERSON, backends.settings())
    with pytest.raises(HthorError, match="no http address"):
        head.choose(situation())
    monkeypatch.setenv(backends.URL, "stub")
    assert backends.make_policy(PERSON, backends.settings()).answer(offer()) == "accept"


# -------------------------------------------------------------------------------------------------------------- clones


def made(count: int, weights, root: int = 5):
    """Choices that a conditional logit of these weights would make."""
    chance = np.random.Generator(np.random.Philox(key=root))
    found = clone.Decisions()
    for _ in range(count):
        rows = [
            [k, u, m, e, float(c), float(d)]
            for k, u, m, e, c, d in zip(
                chance.random(5), chance.random(5), 8 * chance.random(5), 3 * chance.random(5),
                chance.random(5) < 0.3, chance.random(5) < 0.3, strict=True,
            )
        ]  # fmt: skip
        utility = np.array([clone.clone.dot(weights, clone.clone.features(row)) for row in rows])
        found.choices.append((None, rows, int(np.argmax(utility + chance.gumbel(size=5)))))
    return found


def test_a_clone_recovers_the_weights_that_made_the_choices():
    weights = np.array([1.5, 0.5, -2.0, -1.0, -0.7, 0.8])
    values, there, chosen = clone.table(made(4000, weights))
    assert clone.fit_choice(values, there, chosen) == pytest.approx(weights, abs=0.25)


def test_a_clone_recovers_the_logit_of_answers():
    chance = np.random.Generator(np.random.Philox(key=6))
    weights = np.array([-1.0, 2.0, 3.0, 0.4, -0.8, -0.5])
    values = np.column_stack([np.ones(4000), chance.random((4000, 5))])
    said = (chance.random(4000) < 1 / (1 + np.exp(-values @ weights))).astype(float)
    assert clone.fit_answer(values, said) == pytest.approx(weights, abs=0.35)


def test_a_clone_chooses_as_often_as_its_weights_say():
    weights = {"choice": [0.0, 0.0, -1.0, 0.0, 0.0, 0.0], "answer": [0.5, 0.0, 0.0, 0.0, 0.0, 0.0], "ignored": 0.25}
    options = tuple(option(k) for k in range(3))
    heads = [cloned_person.Clone(weights, seeds.derive(0, root)) for root in range(3000)]
    counts = Counter(head.choose(situation(options=options)) for head in heads)
    worth = np.array([1 / (choice.metres + 1) for choice in options])
    assert [counts[k] / 3000 for k in range(3)] == pytest.approx(list(worth / worth.sum()), abs=0.04)
    said = Counter(head.answer(offer()) for head in heads)
    assert said["accept"] / 3000 == pytest.approx(1 / (1 + math.exp(-0.5)), abs=0.04)
    assert said["ignore"] / (3000 - said["accept"]) == pytest.approx(0.25, abs=0.06)


def test_what_the_journal_has_and_what_a_policy_is_told_are_the_same_numbers():
    policy = Recording()
    model, _, _ = played(policy, messages=True)
    choices = [entry for entry in model.journal if entry.kind == "choice"]
    for told, kept in zip([one for one in policy.situations if one.aim == "target"], choices, strict=True):
        rows = [cloned_person.row(choice) for choice in told.options]
        for row, logged in zip(rows, kept.options, strict=True):
            assert row == pytest.approx(logged, abs=0.006)
    offers = [entry for entry in model.journal if entry.kind == "offer"]
    assert len(offers) == len(policy.offers) == 1
    assert cloned_person.reasons(offers[0]) == pytest.approx(cloned_person.reasons(policy.offers[0]), abs=0.01)


def test_the_clone_that_ships_is_better_than_chance_on_people_it_never_saw():
    weights = cloned_person.load()
    held = weights["held_out"]
    assert held["choice"]["clone"]["log_likelihood"] > held["choice"]["chance"]["log_likelihood"] + 0.5
    assert held["answer"]["clone"]["log_likelihood"] > held["answer"]["mean_rate"]["log_likelihood"]
    assert len(weights["choice"]) == len(cloned_person.features([0.1, 0.1, 1.0, 0.0, 0.0, 0.0]))


def test_weights_that_are_not_there_or_not_ours_are_an_error(tmp_path):
    with pytest.raises(HthorError, match=r"examples/clone.py"):
        cloned_person.load(tmp_path / "none.json")
    (tmp_path / "old.json").write_text('{"schema": "other"}')
    with pytest.raises(HthorError, match="other"):
        cloned_person.load(tmp_path / "old.json")


# ----------------------------------------------------------------------------------------------------- the handbook


def test_the_human_models_in_the_handbook_play(root):
    blocks = re.findall(r"```python\n(.*?)```", (root / "docs/people.md").read_text(encoding="utf-8"), re.DOTALL)
    assert len(blocks) == 2
    for code in blocks:
        made: dict = {}
        exec(compile(code, "docs/people.md", "exec"), made)
        person, flat = made["Model"](PERSON), Flat()
        person.begin(flat.briefing(teammates=("robot",)))
        play(person, flat, ticks=300)
        assert person.rate(False, 300) in range(1, 8)
        assert made["Model"](PERSON, dict(person.state())).trials == 1


def test_the_handbook_has_the_clone_s_own_figures(root):
    rows = clone.report(cloned_person.load())
    text = (root / "docs/people.md").read_text(encoding="utf-8")
    assert "\n".join(rows) in text
