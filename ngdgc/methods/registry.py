"""The methods by the names that they have on the command line and in files."""

from dataclasses import fields
from typing import Any

from .conforming import Conforming
from .overpenalised import WeaklyOverPenalised
from .penaltyfree import PenaltyFreeLDG
from .rows import LDG, BassiEtAl, BrezziEtAl, IncompleteInteriorPenalty, InteriorPenalty, NonsymmetricInteriorPenalty

METHODS: dict[str, Any] = {
    "ip": InteriorPenalty, "bassi": BassiEtAl, "brezzi": BrezziEtAl, "ldg": LDG, "ldg0": PenaltyFreeLDG,
    "nipg": NonsymmetricInteriorPenalty, "iipg": IncompleteInteriorPenalty, "wopsip": WeaklyOverPenalised, "h1": Conforming}
PAPER = "ip", "bassi", "brezzi", "ldg", "h1"        # the methods that the paper compares


def Options(row: Any) -> set[str]:
    """Names of the arguments of a method.

    >>> "penalty" in Options(LDG), "penalty" in Options(Conforming)
    (True, False)
    """
    return {field.name for field in fields(row)}


def TakesForm(name: str) -> bool:
    """Have the methods of this name, one of METHODS or "all", an edge form and a lifting form?"""
    return name not in METHODS or "form" in Options(METHODS[name])


def MethodWords() -> str:
    """The names with what they stand for, for help texts."""
    return ", ".join(f"{name} ({row.__name__})" for name, row in METHODS.items())
