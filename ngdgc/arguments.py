"""Types of command line arguments: what is wrong with one is said in one line."""

import argparse
import math
from pathlib import Path

from .exceptions import ProblemError


def Positive(text):
    """A positive integer."""
    try:
        value = int(text)
    except ValueError:
        value = 0
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a positive integer")
    return value


def Finite(text):
    """A finite float."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number")
    return value


def NumberOrAuto(text):
    return text if text == "auto" else Finite(text)


def Folder(name):
    """The folder of this name, made if need be; ProblemError if that fails."""
    folder = Path(name)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ProblemError(f"cannot write into {name}: {error.strerror}") from error
    return folder
