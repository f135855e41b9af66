"""Korn's constants of elements."""

import numpy as np
import pytest
from ngsolve import ET

from ngdgc.estimates import korn
from ngdgc.estimates.korn import KornConstants
from ngdgc.meshes import RectangleMesh, UnitMesh
from ngdgc.studies.samples import BodyMesh


@pytest.mark.parametrize("cells, et, degree, square", [
    ("quad", ET.QUAD, 2, 3), ("quad", ET.QUAD, 3, 5), ("triangle", ET.TRIG, 2, 7), ("triangle", ET.TRIG, 3, 15),
    ("hex", ET.HEX, 2, 3), ("hex", ET.HEX, 3, 5)])
def test_constants_of_low_degrees(cells, et, degree, square, monkeypatch):
    """Squares are whole numbers for low degrees.

    Of quadratic w on a square with rotation x - 1/2, of which grad w has two, strains -a (y - 1/2) along x and shears
    (1 - a) (x - 1/2) are possible, of square a^2/12 + 2 (1 - a)^2/12, at least 2/3/12: the quotient is 2 over 2/3.
    """
    monkeypatch.setattr(korn, "DEGREE", degree)
    mesh = UnitMesh(2, cells)
    assert KornConstants(mesh, et, np.arange(mesh.ne)) / korn.MARGIN == pytest.approx(np.sqrt(square), rel=1e-10)


@pytest.mark.parametrize("scale", [(3.0, 1.0), (1.0, 3.0)])
def test_long_elements_have_larger_ones(scale):
    """A similarity changes nothing, a length of 3 times the width about twice."""
    meshes = RectangleMesh(1, upper=scale, cells="quad"), RectangleMesh(1, cells="quad"), RectangleMesh(5, cells="quad")
    c, one, same = (KornConstants(mesh, ET.QUAD, np.arange(mesh.ne)) for mesh in meshes)
    assert same == pytest.approx(one[0], rel=1e-7) and 2 < c[0] / one[0] < 2.3


def test_every_element_has_its_own():
    """Of a mesh with elements of several shapes, each as computed alone."""
    mesh = BodyMesh(2, "cad", 2)
    every = KornConstants(mesh, ET.TRIG, np.arange(mesh.ne))
    assert np.ptp(every) > 0.1
    for element in (0, mesh.ne - 1):
        assert KornConstants(mesh, ET.TRIG, np.array([element])) == pytest.approx(every[element], rel=1e-10)
