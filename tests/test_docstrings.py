"""Every public name says in its docstring, in a form that tools read, what its parameters are."""

from __future__ import annotations

import dataclasses
import inspect
import re
from collections.abc import Iterator
from types import ModuleType
from typing import Any

import pytest

import contactdd as cd

#: Where parameters are described: of a function, and of what a dataclass is made from.
SECTIONS = ("Args", "Attributes")


def public() -> Iterator[tuple[str, Any]]:
    """The public functions and classes by their full names."""
    for holder, names in ((cd, cd.__all__), (cd.reference, cd.reference.__all__)):
        for name in names:
            thing = getattr(holder, name)
            if not isinstance(thing, ModuleType) and (inspect.isclass(thing) or inspect.isfunction(thing)):
                yield f"{holder.__name__}.{name}", thing


def members(thing: type) -> Iterator[tuple[str, Any]]:
    """The public methods and properties that a class defines itself."""
    for name, member in vars(thing).items():
        if not name.startswith("_") and (inspect.isfunction(member) or isinstance(member, property | classmethod)):
            yield name, member


def parameters(function: Any) -> list[str]:
    """The names of a function's parameters."""
    kinds = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
    found = inspect.signature(function).parameters.values()
    return [p.name for p in found if p.name not in ("self", "cls") and p.kind not in kinds]


def described(docstring: str | None) -> set[str]:
    """The names that a Google-style docstring describes."""
    names: set[str] = set()
    for section in SECTIONS:
        for block in re.findall(
            rf"^{section}:\n((?:[ \t]+.*\n?|\n)+)", inspect.cleandoc(docstring or ""), re.MULTILINE
        ):
            for entry in re.findall(r"^ {4}(\w[\w, *`]*?)(?: \([^)]*\))?:", block, re.MULTILINE):
                names |= {part.strip(" *`") for part in entry.split(",")}
    return names


def undescribed() -> Iterator[str]:
    """All parameters and members of which no docstring speaks."""
    for name, thing in public():
        if not inspect.getdoc(thing):
            yield name
        if inspect.isfunction(thing):
            yield from (f"{name}({each})" for each in parameters(thing) if each not in described(thing.__doc__))
            continue
        if dataclasses.is_dataclass(thing):
            made_from = [field.name for field in dataclasses.fields(thing) if field.init and field.name[0] != "_"]
        else:
            made_from = parameters(thing.__init__) if "__init__" in vars(thing) else []
        known = described(thing.__doc__) | described(getattr(thing.__init__, "__doc__", None))
        if not issubclass(thing, BaseException):
            yield from (f"{name}({each})" for each in made_from if each not in known)
        for member, function in members(thing):
            if isinstance(thing, type) and thing is not cd.LocalProblem and hasattr(cd.LocalProblem, member):
                continue  # a local problem's members are described with the contract
            function = function.__func__ if isinstance(function, classmethod) else function
            if not inspect.getdoc(getattr(thing, member)):
                yield f"{name}.{member}"
            elif inspect.isfunction(function):
                known = described(inspect.getdoc(getattr(thing, member)))
                yield from (f"{name}.{member}({each})" for each in parameters(function) if each not in known)


def test_every_parameter_is_described():
    assert sorted(undescribed()) == []


@pytest.mark.parametrize(("name", "thing"), list(public()), ids=[name for name, _ in public()])
def test_the_first_sentence_stands_alone(name, thing):
    """Tools show the first line by itself: it ends in a full stop and is no fragment of a list."""
    first = inspect.cleandoc(thing.__doc__).split("\n\n")[0]
    assert first.endswith("."), name


#: Text in double backticks, and inline markup without an end: a substitution |…|, or *… before a letter.
LITERAL, MARKUP = re.compile(r"``.*?``", re.DOTALL), re.compile(r"\|[^\s|][^|\n]*\||(?<![\w*)])\*[A-Za-z]")


@pytest.mark.parametrize(("name", "thing"), list(public()), ids=[name for name, _ in public()])
def test_formulas_are_no_markup(name, thing):
    """The bars of |w| and a leading asterisk are markup to tools that render docstrings, unless they are literals."""
    functions = [function for _, function in members(thing)] if inspect.isclass(thing) else []
    for each in (thing, *functions):
        prose = re.sub(r"^ *(>>>|\.\.\.).*$", "", inspect.getdoc(each) or "", flags=re.MULTILINE)
        assert not MARKUP.findall(LITERAL.sub("", prose)), f"{name}: {each}"
