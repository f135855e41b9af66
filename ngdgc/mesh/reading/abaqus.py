"""Files of Abaqus and CalculiX (.inp): nodes, elements, sets and surfaces; steps, materials and contacts are left out.

Material regions are the ELSETs of *SOLID SECTION, else those of the *ELEMENT lines.  Boundary regions are surfaces of sides,
ELSETs of lines in 2D and of shells or membranes in 3D, and of what these leave free node sets, as far as they hold all corners
of a side of the body.  A node set that holds all of these names nothing.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict

import numpy as np

from ...exceptions import ProblemError
from .shapes import DIM, ROUND, SIDES, Cell, Content

TET = (0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)
PRISM = (0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)
HEX = (0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)
FLAT = {3: Cell("triangle"), 4: Cell("quad"), 6: Cell("triangle", ROUND["triangle"]), 8: Cell("quad", ROUND["quad"])}
CELLS = {"C3D": {4: Cell("tet"), 5: Cell("pyramid"), 6: Cell("prism"), 8: Cell("hex"), 10: Cell("tet", TET),
                 15: Cell("prism", PRISM), 20: Cell("hex", HEX)},
         "T": {2: Cell("line"), 3: Cell("line", ROUND["line"])}, "B": {2: Cell("line"), 3: Cell("line", ROUND["line"])}}
CELLS |= {family: FLAT for family in ("CPS", "CPE", "M3D", "S", "SFM3D")}
CELLS |= {"T2D": CELLS["T"], "T3D": CELLS["T"]}
# What of a type follows the number of nodes: reduced integration, hybrid, incompatible, thermal ones.
KIND = re.compile(r"(C3D|CPS|CPE|SFM3D|M3D|T2D|T3D|S|B)(\d+)[RIHMTE]*$")

Element = tuple[Cell, list[int], str]


class Deck:
    """What is read of the lines of a file, by names in capitals, as Abaqus compares them."""

    def __init__(self, file: str) -> None:
        self.file = file
        self.nodes: dict[int, list[float]] = {}
        self.elements: dict[int, Element] = {}
        self.sets: dict[str, dict[str, list[int]]] = {"NSET": defaultdict(list), "ELSET": defaultdict(list)}
        self.surfaces: dict[str, list[list[str]]] = defaultdict(list)
        self.sections: list[str] = []

    def Read(self, text: str) -> None:
        keyword, words, cards = "", dict[str, str](), list[list[str]]()
        for line in [*text.splitlines(), "*"]:
            if line.startswith("**") or not line.strip():
                continue
            if not line.startswith("*"):
                cards.append([word.strip() for word in line.split(",")])
                continue
            self._Cards(keyword, words, cards)
            head, *options = (word.strip() for word in line[1:].split(","))
            keyword, cards = head.upper(), []
            words = {name.strip().upper(): value.strip().strip('"')
                     for name, _, value in (option.partition("=") for option in options)}

    def _Cards(self, keyword: str, words: dict[str, str], cards: list[list[str]]) -> None:
        if keyword in ("INCLUDE", "INSTANCE"):
            raise ProblemError(f"{self.file} has *{keyword}, whose lines are elsewhere; give one file with all nodes and "
                               "elements")
        if keyword == "NODE":
            for number, *point in cards:
                self.nodes[int(number)] = [*(float(word) for word in point if word), 0.0, 0.0][:3]
            self._Add("NSET", words.get("NSET"), [int(card[0]) for card in cards])
        elif keyword == "ELEMENT":
            self._Elements(words, cards)
        elif keyword in self.sets:
            self._Set(keyword, words, cards)
        elif keyword == "SURFACE":
            name = words.get("NAME", "")
            if words.get("TYPE", "ELEMENT").upper() == "NODE":
                for target, *_ in cards:
                    self._Add("NSET", name, self._Members("NSET", target))
            else:
                self.surfaces[name] += cards
        elif keyword == "SOLID SECTION":
            self.sections.append(words.get("ELSET", ""))

    def _Elements(self, words: dict[str, str], cards: list[list[str]]) -> None:
        match = KIND.match(words.get("TYPE", "").upper())
        cell = CELLS[match[1]].get(int(match[2])) if match else None
        if cell is None:
            raise ProblemError(f"{self.file} has elements of type {words.get('TYPE')!r}; solids C3D4, 5, 6, 8, 10, 15, 20 "
                               "and plane CPS and CPE 3, 4, 6, 8 are read")
        numbers = [int(word) for card in cards for word in card if word]
        for row in np.reshape(numbers, (-1, cell.nodes + 1)).tolist():
            if cell.shape == "line" and cell.edges:
                row[2:] = row[:1:-1]        # the node in the middle comes second
            self.elements[row[0]] = cell, row[1:], words.get("ELSET", "")
            self._Add("ELSET", words.get("ELSET"), row[:1])

    def _Set(self, keyword: str, words: dict[str, str], cards: list[list[str]]) -> None:
        members = list[int]()
        for card in cards:
            if "GENERATE" in words:
                first, last, *step = (int(word) for word in card if word)
                members += range(first, last + 1, *step)
            else:
                members += [number for word in card if word for number in self._Members(keyword, word)]
        self._Add(keyword, words.get(keyword), members)

    def _Members(self, keyword: str, word: str) -> list[int]:
        """The number that a word is, or those of the set that it names."""
        if word.isdigit():
            return [int(word)]
        return {name.upper(): numbers for name, numbers in self.sets[keyword].items()}[word.upper()]

    def _Add(self, keyword: str, name: str | None, numbers: list[int]) -> None:
        if name:
            self.sets[keyword][next((old for old in self.sets[keyword] if old.upper() == name.upper()), name)] += numbers

    def Faces(self, name: str) -> list[tuple[int, ...]]:
        """Numbers of the corners of the sides of a surface."""
        found = list[tuple[int, ...]]()
        for target, *rest in self.surfaces[name]:
            side = int(rest[0].upper().removeprefix("S"))
            for number in self._Members("ELSET", target):
                cell, nodes, _ = self.elements[number]
                found.append(tuple(nodes[corner] for corner in SIDES[cell.shape][side - 1]))
        return found


def ReadAbaqus(text: str, file: str) -> Content:
    """What a file of Abaqus or CalculiX holds; ProblemError if it has no nodes and elements, or numbers that are none."""
    deck = Deck(file)
    try:
        deck.Read(text)
        return _Content(deck)
    except ProblemError:        # a ValueError, too
        raise
    except (ValueError, IndexError, KeyError) as error:
        raise ProblemError(f"{file} is no mesh of Abaqus or CalculiX ({error}); write *NODE, *ELEMENT and sets in one file"
                           ) from error


def _Content(deck: Deck) -> Content:
    place = {number: row for row, number in enumerate(deck.nodes)}
    dim = max((DIM[cell.shape] for cell, _, _ in deck.elements.values()), default=0)
    materials: dict[int, tuple[str, ...]] = defaultdict(tuple)
    for name in dict.fromkeys(deck.sections):
        for number in deck._Members("ELSET", name):
            materials[number] += (name,)
    rows: dict[tuple[Cell, tuple[str, ...]], list[list[int]]] = defaultdict(list)
    for number, (cell, nodes, name) in deck.elements.items():
        own = (name,) if name else ()
        rows[cell, materials[number] or own if DIM[cell.shape] == dim else own].append([place[node] for node in nodes])
    blocks = [(cell, np.array(found), names) for (cell, names), found in rows.items()]
    sides = {name: [tuple(place[node] for node in face) for face in deck.Faces(name)] for name in deck.surfaces}
    groups = [(name, dim - 1) for name in sides]
    taken = {frozenset(face) for faces in sides.values() for face in faces}
    taken |= {frozenset(row[:2 if dim == 2 else _Corners(cell)]) for cell, found, _ in blocks if DIM[cell.shape] == dim - 1
              for row in found.tolist()}
    skin = _Skin([(cell, found) for cell, found, _ in blocks if DIM[cell.shape] == dim])
    for name, numbers in deck.sets["NSET"].items():
        members = {place[number] for number in numbers}
        held = [row for row in skin if members.issuperset(row)]
        free = [row for row in held if frozenset(row) not in taken]
        if free and len(held) < len(skin):
            sides.setdefault(name, []).extend(free)
    return Content(np.array(list(deck.nodes.values())), blocks, sides, groups)


def _Corners(cell: Cell) -> int:
    return cell.nodes - len(cell.edges)


def _Skin(blocks: list[tuple[Cell, np.ndarray]]) -> list[tuple[int, ...]]:
    """Corners of the sides that one element alone has."""
    rows = [tuple(row) for cell, found in blocks for side in SIDES[cell.shape] for row in found[:, list(side)].tolist()]
    count = Counter(frozenset(row) for row in rows)
    return [row for row in rows if count[frozenset(row)] == 1]
