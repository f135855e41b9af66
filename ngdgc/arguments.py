"""Types of command line arguments: what is wrong with one is said in one line."""

import argparse
import math


def Positive(text):
    """A positive integer."""
    try:
        value = int(text)
    except ValueError:
        value = 0
    if value < 1:
        raise argparse.ArgumentTypeError(f"{text!r} is not a positive integer; give for example 4")
    return value


def Finite(text):
    """A finite float."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text!r} is not a number; give for example 0.5")
    return value


def NumberOrAuto(text):
    return text if text == "auto" else Finite(text)
