"""docs/conventions.md is true: its letters are those of the code, its arrays have the shapes it says, dofs its numbers."""

import ast
import re
from math import prod
from pathlib import Path

import numpy as np
import pytest
from ngsolve import VOL, ElementId, x

from ngdgc import LDG, ContactProblem, Discretization, Foundation, HookeMaterial, NormalCompliance, Solve
from ngdgc.blocks.reference import Reference
from ngdgc.mesh.quadrature import BoundaryQuadrature
from ngdgc.meshes import BoxMesh, RectangleMesh

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "conventions.md").read_text(encoding="utf-8")


def Rows(heading):
    """Cells of the rows of the table below a heading."""
    section = PAGE.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in section.splitlines() if line.startswith("|")]
    return rows[2:]


LETTERS = {letter for row in Rows("Letters") for letter in re.findall(r"`(\w)`", row[0])}
DENSE = [path for part in ("blocks", "mesh", "contact") for path in (ROOT / "ngdgc" / part).glob("*.py")]


def Subscripts(text):
    """The subscripts of all calls of einsum in a source."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "einsum":
            yield node.args[0].value


def Strange(text):
    """Subscripts with letters of none, or whose result does not begin with n, then q, as far as it has them."""
    for subscripts in Subscripts(text):
        result = subscripts.split("->")[1]
        leading = "".join(letter for letter in "nq" if letter in result)
        if set(subscripts) - LETTERS - set(",->.") or not result.startswith(leading):
            yield subscripts


def test_every_index_is_a_letter_of_the_page():
    texts = [path.read_text(encoding="utf-8") for path in DENSE]
    assert sum(len(list(Subscripts(text))) for text in texts) > 12
    assert [strange for text in texts for strange in Strange(text)] == []
    assert list(Strange('np.einsum("nxj,nxj->nx", a, b); np.einsum("nqi,nqi->qn", a, b)')) == ["nxj,nxj->nx", "nqi,nqi->qn"]


@pytest.fixture(scope="module", params=[RectangleMesh(2, cells="quad"), RectangleMesh(2), BoxMesh(1, cells="prism")],
                ids=["quad", "triangle", "prism"])
def names(request):
    """What the table of arrays speaks of, for a material that varies: then there are points."""
    material = HookeMaterial(E=100 * (1 + x), nu=0.3)
    problem = ContactProblem(material, Foundation("bottom", NormalCompliance(10)), dirichlet={"top": (0,) * request.param.dim})
    solution = Solve(Discretization(problem, LDG(), request.param, order=2))
    disc, operators = solution.disc, solution.disc.form.operators
    patch, star = max(operators.FacetPatches(), key=lambda one: one.elements.shape[1]), next(operators.Stars())
    group = patch.sides[0].group
    ranks = tuple(range(disc.facets.vertices.shape[1]))
    return {"disc": disc, "facets": disc.facets, "operators": operators, "group": group, "patch": patch, "side": patch.sides[0],
            "star": star, "shape": Reference(group.et, ranks, 2, 2, material.bonus), "contact": disc.contact,
            "solution": solution, "quadrature": BoundaryQuadrature.On(disc.facets, "bottom", 4)}


def Sizes(names, code):
    """How many of each letter there are in an array, given by its code."""
    disc, group = names["disc"], names["group"]
    shape = names["shape"].facets[0] if "facets[0]" in code else names["shape"]
    around = next((names[name] for name in ("patch", "star") if name in code), names["patch"])
    counts = {"group": len(group.elements), "patch": len(around.elements), "star": len(around.elements),
              "operators": len(around.elements), "side": len(names["side"].rows),
              "quadrature": len(names["quadrature"].weights),
              "contact": len(disc.contact.weights), "solution": len(disc.contact.weights)}
    slot = int(names["side"].slots[0]) if "patch" in code else 0
    a, b, dim = group.na, group.nb(slot), disc.mesh.dim
    sides = len(disc.facets.ofelements)
    return {"n": counts.get(code.split(".")[0]), "q": len(shape.weights), **dict.fromkeys("ijklmt", dim), "a": a, "b": b,
            "p": group.nl, "c": len(group.basis), "s": len(group.sides), "e": around.elements.shape[1],
            "v": dim * around.elements.shape[1] * a, "r": dim * b, "3": 3, "ndof": disc.space.ndof,
            "facets": len(disc.facets.neighbours), "elements": disc.mesh.ne, "sides": sides,
            "corners": disc.facets.vertices.shape[1]}


def Wrong(names, rows):
    """Arrays of other shapes than the table says."""
    for code, shape, _ in rows:
        code, sizes = code.strip("`"), Sizes(names, code.strip("`"))
        axes = re.findall(r"\([^()]*\)|\w+", shape[1:-1])
        wanted = tuple(prod(sizes[letter] for letter in axis.strip("()").split()) for axis in axes)
        if eval(code, dict(names)).shape != wanted:
            yield code, wanted


def test_arrays_have_the_shapes_of_the_page(names):
    rows = Rows("Arrays")
    assert len(rows) > 30 and list(Wrong(names, rows)) == []
    wrong = [["`operators.Jumps(patch)`", "(n, v, r)", ""], ["`group.Trace(0)`", "(n, (k a), (i b))", ""]]
    assert len(list(Wrong(names, wrong))) == 2


def test_dofs_are_numbered_component_by_component(names):
    disc, operators = names["disc"], names["operators"]
    for element in (0, disc.mesh.ne - 1):
        dofs = operators.Dofs(np.array([[element]]))[0]
        assert dofs.tolist() == list(disc.space.GetDofNrs(ElementId(VOL, element)))
        starts = operators.starts
        assert dofs[operators.groups[0].na] == starts[-1] + starts[element]     # (k, a) = (1, 0)


def test_the_element_with_the_smaller_number_fixes_the_orientation(names):
    patch = names["patch"]
    first, second = patch.sides
    assert np.all(patch.elements[:, 0] < patch.elements[:, 1])
    assert np.all(first.sign == 1) and np.all(second.sign == -1)
