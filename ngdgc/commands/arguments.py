"""Types of command line arguments: what is wrong with one is said in one line."""

import argparse
import math


def Positive(text):
    """A positive integer."""
    return _Integer(text, 1, "a positive integer; give for example 4")


def Natural(text):
    """A nonnegative integer."""
    return _Integer(text, 0, "a nonnegative integer; give for example 0")


def _Integer(text, least, words):
    try:
        value = int(text)
    except ValueError:
        value = least - 1
    if value < least:
        raise argparse.ArgumentTypeError(f"{text!r} is not {words}")
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
