"""Tables of words: columns begin or end below each other, and a table of Markdown has the cells that were given."""

import numpy as np
import pytest

from ngdgc.tools.tables import Aligned, Piped

RANDOM = np.random.default_rng(1)
ROWS = [["x" * length for length in lengths] for lengths in RANDOM.integers(1, 12, (7, 4))]


def Edges(lines, end):
    """Where the cells of a table begin, or end, {column: places}."""
    places = [{} for _ in ROWS[0]]
    for line in lines:
        start = 0
        for column, cell in enumerate(line.split()):
            start = line.index(cell, start)
            places[column].setdefault(start + end * len(cell), line)
            start += len(cell)
    return [set(found) for found in places]


def test_columns_begin_below_each_other_and_numbers_end_there():
    words, numbers = Aligned(iter(ROWS)), Aligned(ROWS, numbers=True)
    assert [line.split() for line in words] == [line.split() for line in numbers] == ROWS
    assert [len(found) for found in Edges(words, end=False)] == [1] * 4
    first, *others = Edges(numbers, end=True)
    assert [len(found) for found in others] == [1] * 3 and len(first) > 1
    assert max(map(len, words)) == max(map(len, numbers)) == sum(max(map(len, column)) for column in zip(*ROWS)) + 2 * 3
    # Control: cells that are only joined do neither.
    joined = ["  ".join(row) for row in ROWS]
    assert all(len(found) > 1 for end in (False, True) for found in Edges(joined, end)[1:])


def test_no_line_ends_with_blanks():
    assert Aligned([("a", ""), ("", "b"), ("", "")]) == ["a", "   b", ""]


@pytest.mark.parametrize("rows", [ROWS, ROWS[:1]])
def test_markdown_has_the_cells(rows):
    head, rule, *others = Piped(iter(rows))
    assert [[cell.strip() for cell in line.strip("|").split("|")] for line in (head, *others)] == rows
    assert rule == "|---|---|---|---|"
