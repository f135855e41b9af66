"""Tables of computed numbers, as executed pages show them."""

import re
from pathlib import Path

DOCS = Path(__file__).parent


class Table:
    """A Markdown table that a notebook or a page shows as such.

    >>> print(Table(("h", "error"), [(0.5, 1e-3)]).text)
    | h | error |
    |---|---|
    | 0.5 | 0.001 |
    """

    def __init__(self, header, rows):
        rows = [[cell if isinstance(cell, str) else f"{cell:.4g}" for cell in row] for row in rows]
        lines = [header, ["---"] * len(header), *rows]
        self.text = "\n".join("|---" * len(header) + "|" if line[0] == "---" else
                              "| " + " | ".join(cell.replace("|", r"\|") for cell in line) + " |" for line in lines)

    def _repr_markdown_(self):
        return self.text

    def __repr__(self):
        return self.text


def Relative(computed, expected):
    """The difference in words: relative, or absolute where zero is expected.

    >>> Relative(1.01, 1), Relative(1e-9, 0)
    ('+1 %', '1e-09')
    """
    return f"{100 * (computed / expected - 1):+.2g} %" if expected else f"{computed - expected:.2g}"


def Escape(text):
    """Text in which Markdown finds no markup but `code`.

    >>> Escape("a*b, `c*d`")
    'a\\\\*b, `c*d`'
    """
    parts = text.split("`")
    parts[::2] = [re.sub(r"([\\*_<>$\[\]{}|])", r"\\\1", part) for part in parts[::2]]
    return "`".join(parts)


def Lines(page, start):
    """Lines of a generated page that begin with some words, such as "* Example 4.1, closest"."""
    return [line for line in (DOCS / page).read_text(encoding="utf-8").splitlines() if line.startswith(start)]
