"""Types of command line arguments: what is wrong with one is said in one line."""

from __future__ import annotations

import argparse
import math
from typing import Any, Protocol


class Commands(Protocol):
    """What parsers of commands are added to: `add_subparsers` of argparse returns it."""

    def add_parser(self, name: str, *given: Any, **words: Any) -> argparse.ArgumentParser: ...


def Positive(text: str) -> int:
    """A positive integer."""
    return _Integer(text, 1, "a positive integer; give for example 4")


def Natural(text: str) -> int:
    """A nonnegative integer."""
    return _Integer(text, 0, "a nonnegative integer; give for example 0")


def _Integer(text: str, least: int, words: str) -> int:
    try:
        value = int(text)
    except ValueError:
        value = least - 1
    if value < least:
        raise argparse.ArgumentTypeError(f"{text!r} is not {words}")
    return value


def Finite(text: str) -> float:
    """A finite float."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number; give for example 0.5")
    return value


def NumberOrAuto(text: str) -> float | str:
    return text if text == "auto" else Finite(text)
