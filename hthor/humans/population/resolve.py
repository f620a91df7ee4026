"""What a word of `--humans` stands for: a human model and the population that its participants are drawn from.

A word is the name of a population ("study"), of a kind ("cautious"), of a human model ("greedy"), or the path of a file
that holds one (pop.npz, my_kind.json, my_human.py). A model with a source has it after a colon ("replay:runs/demo").
``WORD@POPULATION`` uses a kind or a model with another population than the default.
"""

import re
from pathlib import Path
from typing import Any

from msgspec import Struct

from hthor import documents, jsonio, plugins
from hthor.errors import PopulationError, UnknownName
from hthor.humans.model import HumanModel, State
from hthor.humans.population import kinds, population_file
from hthor.humans.population.kinds import PopulationKind
from hthor.humans.population.participant import Participant
from hthor.humans.population.population import Population

PROXY = "proxy"
"""The human model that populations are fitted with; as a word of `--humans`, it has the default population."""
_SORT = "human model"
_HINT = "Or give a path: pop.npz of a population, my_kind.json of a kind of people, my_human.py of a human model."


class ParticipantSource(Struct, frozen=True, kw_only=True, eq=False):
    """Where the participants of a run come from: a human model and a population.

    Attributes:
        name: a name for tables and files, without folders.
        word: a word of `--humans` that means the same in any process and from any folder.
        purpose: a few words about these people.
        model: the human model's name, or the path of its file.
        source: what the model is made from instead of a population, such as a log to replay; usually empty.
        kind: changes to the population, None for none.
        sha256: hash of everything that decides how participants behave, except hthor's own code.
    """

    name: str
    word: str
    purpose: str
    model: str
    source: str
    population: Population
    kind: PopulationKind | None
    sha256: str

    def participant(self, seed: int, participant: int) -> Participant:
        """Participant number ``participant`` of the study with this seed, whichever robots they meet.

        Models whose class says ``alike = True`` get the population's mean.
        """
        if self.model != PROXY and getattr(plugins.load(_SORT, self.model), "alike", False):
            return Participant(seed=seed, number=participant, traits=self.population.mean())
        change = self.kind.change if self.kind is not None else None
        return Participant(seed=seed, number=participant, traits=self.population.draw_traits(seed, participant, change))

    def make_model(self, seed: int, participant: int, state: State | None = None) -> HumanModel:
        """The human model of that participant, before the first trial or with what they remember of earlier ones."""
        model, person = plugins.load(_SORT, self.model), self.participant(seed, participant)
        given: dict[str, Any] = {"state": state} if state else {}
        made: HumanModel = model(person, **given, source=self.source) if self.source else model(person, **given)
        return made


def default_population() -> str:
    """The population that is used when none is named."""
    return (
        population_file.CALIBRATED_POPULATION
        if population_file.CALIBRATED_POPULATION in population_file.names()
        else population_file.PRIOR_POPULATION
    )


def human_names() -> tuple[str, ...]:
    """Every word of `--humans` that is not a path: populations, kinds, models."""
    return (*population_file.names(), *kinds.names(), *plugins.names(_SORT))


def resolve_humans(word: str) -> ParticipantSource:
    """What a word of `--humans` stands for.

    Raises:
        UnknownName: when nothing has that name.
        PopulationError: when a file of a population or kind cannot be used.
        HthorError: when a human model's file does not load.
    """
    word = "@".join(map(population_file.population_name, word.split("@")))
    left, base = _split(word)
    if left in population_file.names() or left.endswith(".npz") or _schema(left) == population_file.SCHEMA:
        if base is not None:
            raise PopulationError(word, "@", f"'{left}' is a population itself; write a kind or a model before the @")
        return _people(word, left, PROXY, "", population_file.load_population(left), None)
    if left in kinds.names() or left.endswith(".json"):
        kind = kinds.load(left)
        return _people(
            word, left, PROXY, "", base or population_file.load_population(kind.base or default_population()), kind
        )
    model, _, source = (left, "", "") if left.endswith(".py") else left.partition(":")
    if model not in plugins.names(_SORT) and not model.endswith(".py"):
        raise UnknownName("people", word, human_names(), _HINT)
    if model.endswith(".py"):
        plugins.load(_SORT, model)  # now, not in the middle of a run
    return _people(word, left, model, source, base or population_file.load_population(default_population()), None)


def _split(word: str) -> tuple[str, Population | None]:
    """The word before the last @ and the population after it, None without an @."""
    left, at, right = word.rpartition("@")
    if not at or Path(word).exists() or not (right in population_file.names() or right.endswith((".npz", ".json"))):
        if at and not Path(word).exists():
            raise UnknownName(
                "population", right, population_file.names(), "After the @ comes a population or its file."
            )
        return word, None
    return left, population_file.load_population(right)


def _people(
    word: str, left: str, model: str, source: str, population: Population, kind: PopulationKind | None
) -> ParticipantSource:
    made = {
        "model": model if not model.endswith(".py") else plugins.sha256(model),
        "population": "" if source else population.sha256,
        "changes": [] if kind is None else kind.essence,
        "ingredients": _ingredients(model, source),
    }
    digest = jsonio.sha256(made)
    return ParticipantSource(
        name="@".join(_named(part, digest) for part in _parts(word, left)),
        word="@".join(_anywhere(part) for part in _parts(word, left)),
        purpose=_purpose(left, model, population, kind),
        model=_anywhere(model),
        source=source and str(Path(source).resolve()),
        population=population,
        kind=kind,
        sha256=digest,
    )


def _named(word: str, digest: str) -> str:
    """A name for tables; a user's file with a name that hthor uses itself gets a part of its hash too."""
    name = _plain(word)
    own = word in human_names() or not word.endswith((".npz", ".json", ".py"))
    return name if own or name not in human_names() else f"{name}-{digest[:6]}"


def _purpose(left: str, model: str, population: Population, kind: PopulationKind | None) -> str:
    if kind is not None:
        return kind.purpose
    return plugins.summary(_SORT, model) if left.partition(":")[0] == model else population.purpose


def _ingredients(model: str, source: str) -> Any:
    """Everything else that decides how a model behaves, from its `ingredients`; see `hthor.humans.model`."""
    if model == PROXY:
        return {}
    plugins.load(_SORT, model)
    module = plugins.loaded(_SORT, Path(model).stem if model.endswith(".py") else model)
    tell = getattr(module, "ingredients", None)
    return tell(source) if tell is not None else {"source": source} if source else {}


def _parts(word: str, left: str) -> tuple[str, ...]:
    return (left,) if word == left else (left, word[len(left) + 1 :])


def _plain(word: str) -> str:
    """A name fit for file names: "pop" for dir/pop.npz, "replay-demo" for replay:runs/demo."""
    model, colon, source = word.partition(":")
    stem = (
        Path(word).stem
        if word.endswith((".npz", ".json", ".py"))
        else f"{model}-{Path(source).stem}"
        if colon
        else word
    )
    return re.sub(r"[^A-Za-z0-9_-]+", "-", stem).strip("-")[:60] or "people"


def _anywhere(word: str) -> str:
    """The same word with an absolute path."""
    if word.endswith((".npz", ".json", ".py")):
        return str(Path(word).resolve())
    model, colon, source = word.partition(":")
    return f"{model}:{Path(source).resolve()}" if colon else word


def _schema(word: str) -> str:
    """The schema named by a JSON file, empty for anything else."""
    return documents.schema_of(Path(word)) if word.endswith(".json") else ""
