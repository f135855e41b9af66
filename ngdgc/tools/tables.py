"""Tables of words, as lines of a terminal and as lines of Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def Aligned(rows: Iterable[Sequence[str]], *, numbers: bool = False) -> list[str]:
    """Lines of text whose columns stand below each other, two spaces apart; `rows` are cells, the head among them.

    numbers : the cells of all columns but the first end below each other instead of beginning there

    >>> Aligned([("h", "error"), ("1/2", "9.5"), ("1/16", "0.375")])
    ['h     error', '1/2   9.5', '1/16  0.375']
    >>> Aligned([("h", "error"), ("1/2", "9.5"), ("1/16", "0.375")], numbers=True)
    ['h     error', '1/2     9.5', '1/16  0.375']
    """
    rows = list(rows)
    widths = [max(map(len, column)) for column in zip(*rows)]
    return ["  ".join(cell.rjust(width) if numbers and column else cell.ljust(width)
                      for column, (cell, width) in enumerate(zip(row, widths))).rstrip() for row in rows]


def Piped(rows: Iterable[Sequence[str]]) -> list[str]:
    """Lines of a table in Markdown, the first of `rows` as its head.

    >>> Piped([("h", "error"), ("1/2", "9.5")])
    ['| h | error |', '|---|---|', '| 1/2 | 9.5 |']
    """
    head, *others = rows
    return ["| " + " | ".join(head) + " |", "|---" * len(head) + "|", *("| " + " | ".join(row) + " |" for row in others)]
