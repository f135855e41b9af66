"""scipy.sparse, imported where a name of it is first used: that takes as long as to import all of this package."""

from __future__ import annotations

from importlib import import_module
from typing import Any


def __getattr__(name: str) -> Any:
    value = globals()[name] = getattr(import_module("scipy.sparse"), name)
    return value
