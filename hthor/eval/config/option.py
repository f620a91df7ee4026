"""One option of a command: what its record's field says of it, and the check of a value that somebody gave.

A record of options is a Struct whose fields are annotated with `Option`. `fields` reads such a record, and everything
else that knows the options is made from it: the command line, its help, the signature in Python, and the checks.
"""

import functools
import math
import os
import types
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

from msgspec import NODEFAULT, Struct, structs

from hthor.errors import HthorError, UnknownName

_Record = TypeVar("_Record", bound=Struct)
_NOUNS = {str: "text", int: "a whole number", float: "a number", bool: "true or false", Path: "a path"}


class Option(Struct, frozen=True, kw_only=True):
    """What a user is told about an option, beside its name and type, and which numbers it takes.

    Attributes:
        default: the default in words, where it depends on other options.
        placeholder: what stands for the value in the help, where it is not the option's name.
        short: a one-letter name, such as "j".
        least, most: the range of a number.
        negatable: whether a flag also has a form that begins with ``--no-``.
        kept: whether a run keeps the value for the command that goes on with it, although it changes no trial.
    """

    help: str
    default: str = ""
    placeholder: str = ""
    short: str = ""
    least: float | None = None
    most: float | None = None
    negatable: bool = False
    kept: bool = False


class Field(Struct, frozen=True, kw_only=True):
    """A field of a record of options.

    Attributes:
        types: the types of a value, or of each value where the option is ``repeated``.
        choices: the words that the option takes; empty where it takes any.
        default: the field's default; None where nothing is chosen.
    """

    name: str
    types: tuple[Any, ...]
    choices: tuple[str, ...]
    repeated: bool
    default: Any
    about: Option

    @property
    def flag(self) -> str:
        """The option as the command line names it."""
        return f"--{self.name.replace('_', '-')}"

    def check(self, given: object) -> object:
        """The value of the field for what was given; None, or an empty sequence, stands for the default.

        Raises:
            HthorError: when it has another type, or is out of range.
            UnknownName: when it is a word that the option does not take.
        """
        if given is None or (self.repeated and _is_sequence(given) and not given):
            return self.default
        if not self.repeated:
            return self._check_one(given)
        return tuple(map(self._check_one, given if _is_sequence(given) else (given,)))  # type: ignore[call-overload]

    def words(self, value: object, *, stated: bool = False) -> list[str]:
        """The words of a command line that give this value; none where it is the default, unless it is ``stated``."""
        if value in (None, "") or (value == self.default and not stated):
            return []
        if isinstance(value, bool):
            return [self.flag if value else f"--no-{self.flag[2:]}"]
        values = value if isinstance(value, tuple) else (value,)
        return [word for one in values for word in (self.flag, _short(one) if isinstance(one, float) else str(one))]

    def _check_one(self, given: object) -> object:
        if self.choices and isinstance(given, str):
            if given not in self.choices:
                raise UnknownName(f"value of {self.flag}", given, self.choices)
            return given
        value = self._converted(given)
        if value is None or (isinstance(value, (int, float)) and not isinstance(value, bool) and not self._fits(value)):
            raise HthorError(f"{self.flag} {given!r}: expected {self._expected}.")
        return value

    def _converted(self, given: object) -> object:
        """The value in a type of the option's; None where there is none."""
        if isinstance(given, os.PathLike):
            place = os.fspath(given)
            return Path(place) if Path in self.types else place if str in self.types else None
        if isinstance(given, str):
            return given if str in self.types else Path(given) if Path in self.types else None
        if isinstance(given, bool):
            return given if bool in self.types else None
        if isinstance(given, int) and int in self.types:
            return str(given) if str in self.types else given
        return float(given) if isinstance(given, (int, float)) and float in self.types else None

    def _fits(self, number: float) -> bool:
        least = -math.inf if self.about.least is None else self.about.least
        return math.isfinite(number) and least <= number <= (math.inf if self.about.most is None else self.about.most)

    @property
    def _expected(self) -> str:
        if self.choices:
            return f"one of {', '.join(self.choices)}"
        noun = " or ".join(_NOUNS[kind] for kind in self.types)
        least, most = self.about.least, self.about.most
        limits = [f"at least {least:g}"] if least is not None else []
        limits += [f"at most {most:g}"] if most is not None else []
        one = f"{noun}{', ' if limits else ''}{' and '.join(limits)}"
        return f"{one}, or a list of such" if self.repeated else one


@functools.cache
def fields(record: type[Struct]) -> dict[str, Field]:
    """The options of a record, by name and in its order."""
    hints = get_type_hints(record, include_extras=True)
    found = {}
    for one in structs.fields(record):
        kind, about = get_args(hints[one.name])
        default = one.default_factory() if one.default is NODEFAULT else one.default  # type: ignore[operator]
        repeated = get_origin(kind) is tuple
        union = get_origin(kind) in (Union, types.UnionType)
        kinds = get_args(kind)[:1] if repeated else get_args(kind) if union else (kind,)
        kinds = tuple(part for part in kinds if part is not types.NoneType)
        choices = tuple(word for part in kinds if get_origin(part) is Literal for word in get_args(part))
        found[one.name] = Field(
            name=one.name,
            types=(str,) if choices else kinds,
            choices=choices,
            repeated=repeated,
            default=default,
            about=about,
        )
    return found


def make_record(record: type[_Record], given: Mapping[str, object]) -> _Record:
    """The record of the options that somebody gave, checked.

    Raises:
        UnknownName: for an option that the record does not have.
        HthorError: for a value that an option does not take.
    """
    known = fields(record)
    for name in given:
        if name not in known:
            raise UnknownName("option", name, known)
    return record(**{name: known[name].check(value) for name, value in given.items()})


def kept_values(record: Struct) -> dict[str, str | float]:
    """The values, by name, that a run keeps for the command that goes on with it: those that are not the default."""
    named = [one for one in fields(type(record)).values() if one.about.kept]
    return {one.name: value for one in named if (value := getattr(record, one.name)) != one.default}


def command_words(record: Struct, only: Collection[str] = (), always: Collection[str] = ()) -> list[str]:
    """The words of a command line that give these options, or ``only`` some, in the record's order.

    Options with their default are left out, except those that are ``always`` stated and not empty.
    """
    named = (one for one in fields(type(record)).values() if not only or one.name in only)
    return [word for one in named for word in one.words(getattr(record, one.name), stated=one.name in always)]


def _short(number: float) -> str:
    """A number as a person would type it: 600, not 600.0."""
    return f"{number:g}" if float(f"{number:g}") == number else repr(number)


def _is_sequence(value: object) -> bool:
    return isinstance(value, Sequence) and not isinstance(value, (str, bytes))
