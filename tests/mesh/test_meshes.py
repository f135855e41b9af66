"""Meshes of shapes from CAD: names, curved boundaries, sizes, and mistakes."""

import numpy as np
import pytest
from netgen.occ import Box, Circle, Cylinder, Glue, MoveTo, Pnt, Rectangle, Z
from ngsolve import Integrate

from ngdgc import ProblemError
from ngdgc.meshes import ShapeMesh


@pytest.mark.parametrize("order, least, most", [(1, 1e-3, 1e-1), (2, 1e-7, 1e-3), (4, 0, 1e-6)])
def test_area_of_a_disc_by_the_order_of_its_boundary(order, least, most):
    error = abs(Integrate(1, ShapeMesh(Circle((0, 0), 1).Face(), 0.3, order=order), order=8) / np.pi - 1)
    assert least < error < most


@pytest.mark.slow
def test_names_of_faces_and_solids_are_those_of_the_mesh():
    box = Box(Pnt(0, 0, 0), Pnt(2, 1, 1))
    box.faces.name, box.faces.Min(Z).name, box.name = "wall", "floor", "steel"
    mesh = ShapeMesh(box, 1)
    assert mesh.dim == 3 and set(mesh.GetBoundaries()) == {"wall", "floor"} and mesh.GetMaterials() == ("steel",)
    assert Integrate(1, mesh.Boundaries("floor")) == pytest.approx(2)
    halves = [MoveTo(left, 0).Rectangle(1, 1).Face() for left in (0, 1)]
    for half, name in zip(halves, ("a", "b")):
        half.faces.name = name
    assert ShapeMesh(Glue(halves), 0.5).GetMaterials() == ("a", "b")


def test_small_holes_do_not_decide_the_size_of_the_mesh():
    """maxh does: a plate with a hole of a fiftieth of its size; where an edge asks for small elements there are more."""
    plate, hole = Rectangle(1, 1).Face(), Circle((0.5, 0.5), 0.02).Face()
    coarse, fine = (ShapeMesh(plate - hole, maxh).ne for maxh in (0.2, 0.05))
    assert coarse < 200 and fine > 4 * coarse
    asking = plate - hole
    asking.edges.maxh = 0.02
    assert ShapeMesh(asking, 0.2).ne > 4 * coarse


@pytest.mark.parametrize("shape, arguments, words", [
    ("disc", {"maxh": 1}, "shape is 'disc'; give a face or a solid"),
    (Circle((0, 0), 1).Face(), {"maxh": 0}, "maxh is 0; give the largest size of an element, a positive number"),
    (Circle((0, 0), 1).Face(), {"maxh": float("nan")}, "maxh is nan"),
    (Cylinder(Pnt(0, 0, 0), Z, r=1, h=1), {"maxh": 1, "order": 0}, "order is 0; give the order of the geometry, a positive"),
    (Cylinder(Pnt(0, 0, 0), Z, r=1, h=1), {"maxh": 1, "order": 1.5}, "order is 1.5")])
def test_mistakes_are_named(shape, arguments, words):
    with pytest.raises(ProblemError, match=words):
        ShapeMesh(shape, **arguments)
