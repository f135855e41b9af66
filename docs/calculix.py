"""One block in CalculiX and here: `python docs/calculix.py` writes the table of calculix.md, with `ccx` in the path."""

import re
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from tables import DOCS

E, NU, STIFFNESS, GAP, DOWN = 2000, 0.3, 300, 0.02, 0.1        # N, mm
BEGIN, END = "<!-- written by `python docs/calculix.py` -->\n", "<!-- end of the table -->\n"
# Friction, pull, stick slopes over k_n.
RUNS = ((0.0, 0.05, (None,)), (0.3, 0.05, (10,)), (0.8, 0.05, (10,)), (0.3, 0.01, (1, 10, 100)))
MIDDLES = ((0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0), (1, 0.5), (0.5, 1), (0, 0.5))      # corners and middles of a CPE8


def Grid(lower, upper, cells, first):
    """Lines of nodes and of CPE8 elements of a rectangle; numbers begin after `first`, that of nodes and that of elements."""
    nodes, elements = {}, []
    for j in range(cells[1]):
        for i in range(cells[0]):
            points = [tuple(round(low + (high - low) * (index + part) / count, 9) for low, high, index, part, count
                            in zip(lower, upper, (i, j), middle, cells)) for middle in MIDDLES]
            elements.append([nodes.setdefault(point, first[0] + len(nodes) + 1) for point in points])
    return ([f"{number}, {x:g}, {y:g}, 0" for (x, y), number in nodes.items()],
            [", ".join(map(str, [first[1] + number, *nodes])) for number, nodes in enumerate(elements, 1)])


def Body(n=16):
    """The mesh of the block (0,2) x (0,1), n cells along it, with the surfaces "bottom" and "top", as an input file."""
    nodes, elements = Grid((0, 0), (2, 1), (n, n // 2), (0, 0))
    return "\n".join(["*NODE, NSET=block", *nodes, "*ELEMENT, TYPE=CPE8, ELSET=rubber", *elements,
                      "*SURFACE, NAME=bottom, TYPE=ELEMENT", *(f"{number}, S1" for number in range(1, n + 1)),
                      "*SURFACE, NAME=top, TYPE=ELEMENT",
                      *(f"{number}, S3" for number in range(len(elements) - n + 1, len(elements) + 1)), ""])


def Deck(friction, pull, slope, n=16):
    """The input file of a run: the block, a rigid base below its gap, and contact; slope : of sticking friction over k_n."""
    body = Body(n)
    nodes, elements = Grid((-1, -GAP - 0.2), (3, -GAP), (8, 1), (10 ** 6, 10 ** 6))
    top = [line.split(",")[0] for line in body.splitlines() if line.count(",") == 3 and line.split(",")[2].strip() == "1"]
    return "\n".join([
        body + "*NODE, NSET=base", *nodes, "*ELEMENT, TYPE=CPE8, ELSET=ground", *elements,
        "*SURFACE, NAME=floor, TYPE=ELEMENT", *(f"{10 ** 6 + number}, S3" for number in range(1, 9)),
        "*NSET, NSET=held", *(f"{number}," for number in top),
        "*MATERIAL, NAME=m", "*ELASTIC", f"{E}, {NU}", "*SOLID SECTION, ELSET=rubber, MATERIAL=m",
        "*SOLID SECTION, ELSET=ground, MATERIAL=m", "*SURFACE INTERACTION, NAME=soft",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", f"{STIFFNESS}",
        *(["*FRICTION", f"{friction}, {slope * STIFFNESS}"] if friction else []),
        "*CONTACT PAIR, INTERACTION=soft, TYPE=SURFACE TO SURFACE", "bottom, floor",
        "*STEP, INC=50", "*STATIC, DIRECT", "1, 1", "*BOUNDARY", "base, 1, 2", f"held, 1, 1, {pull}", f"held, 2, 2, {-DOWN}",
        "*NODE PRINT, NSET=base, TOTALS=ONLY", "RF", "*END STEP", ""])


def Forces(deck):
    """Sizes of the tangential and the normal force on the base that CalculiX finds [N/mm]."""
    with TemporaryDirectory() as folder:
        (Path(folder) / "run.inp").write_text(deck, encoding="ascii")
        subprocess.run(["ccx", "run"], cwd=folder, capture_output=True, timeout=300, check=True)
        values = re.findall(r"total force.*\n\s*\n\s*(\S+)\s+(\S+)", (Path(folder) / "run.dat").read_text(encoding="ascii"))
    return abs(float(values[-1][0])), abs(float(values[-1][1]))


def Ours(friction, pull, n=16):
    """The same by `Conforming` of order 2, the elements of CalculiX, and by interior penalty."""
    from ngdgc import (Conforming, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                       NormalCompliance, Solve)
    from ngdgc.meshes import RectangleMesh

    foundation = Foundation("bottom", NormalCompliance(STIFFNESS), gap=GAP,
                            **({"friction": CoulombFriction(friction)} if friction else {}))
    problem = ContactProblem(HookeMaterial(E=E, nu=NU), foundation, dirichlet={"top": (pull, -DOWN)})
    for method in (Conforming(), InteriorPenalty()):
        yield abs(Solve(Discretization(problem, method, RectangleMesh(n, upper=(2, 1), cells="quad"), order=2)).Force("bottom"))


def Written(page):
    """The page with the table as both programs compute it now."""
    lines = ["| friction | pull | stick slope | CalculiX: T, N | H1: T, N | interior penalty: T, N |",
             "|---|---|---|---|---|---|"]
    for friction, pull, slopes in RUNS:
        ours = [f"{tangential:.4f}, {normal:.4f}" for tangential, normal in Ours(friction, pull)]
        for slope in slopes:
            found = Forces(Deck(friction, pull, slope))
            lines.append(f"| {friction:g} | {pull:g} | {f'{slope} k_n' if slope else ''} | {found[0]:.4f}, {found[1]:.4f} "
                         f"| {' | '.join(ours)} |")
    before, rest = page.split(BEGIN)
    return before + BEGIN + "\n" + "\n".join(lines) + "\n\n" + END + rest.split(END)[1]


if __name__ == "__main__":
    page = DOCS / "calculix.md"
    page.write_text(Written(page.read_text(encoding="utf-8")), encoding="utf-8")
    sys.exit(0)
