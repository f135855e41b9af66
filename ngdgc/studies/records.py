"""Records of a long study, each kept as soon as it is there."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from dataclasses import asdict
from typing import IO, Any, TypeVar

Kept = TypeVar("Kept")


def Recorded(made: Iterable[Kept], file: IO[str], callback: Callable[[Kept], object] | None) -> list[Kept]:
    """The dataclasses that are made, each a line of JSON in the file before the callback has it; on Ctrl-C those there are."""
    records: list[Kept] = []
    try:
        for record in made:
            records.append(record)
            data: Any = record
            file.write(json.dumps(asdict(data)) + "\n")
            file.flush()
            if callback is not None:
                callback(record)
    except KeyboardInterrupt:
        pass        # what was computed is the result
    return records
