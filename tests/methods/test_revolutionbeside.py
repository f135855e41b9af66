"""Bodies of revolution beside other ways to the same: a ring in space, and conjugate gradients in the plane."""

import numpy as np
import pytest
from netgen.occ import Box, Cylinder, Z
from ngsolve import y, z
from ngsolve.meshes import MakeStructured2DMesh

from ngdgc import LDG, ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NormalCompliance, Solve
from ngdgc.meshes import RectangleMesh, ShapeMesh

STEEL = HookeMaterial(E=100, nu=0.3)


def QuarterRing():
    """The quarter x, y > 0 of the ring 1 < r < 2, 0 < z < 1, in space."""
    body = (Cylinder((0, 0, 0), Z, 2, 1) - Cylinder((0, 0, 0), Z, 1, 1)) * Box((0, 0, 0), (3, 3, 1))
    for face in body.faces:
        px, py, pz = face.center
        face.name = ("bottom" if pz < 1e-6 else "top" if pz > 1 - 1e-6 else "yz" if px < 1e-6 else "xz" if py < 1e-6
                     else "left" if np.hypot(px, py) < 1.3 else "right")
    return ShapeMesh(body, 0.7, order=2)


def test_ring_in_space_has_the_same_forces():
    """A ring upset in a bore: its quarter in space needs fifty times the unknowns for the same forces, within 1 %."""
    def Upset(height, rollers):
        bore = Foundation("right", NormalCompliance(100), gap=0.002 * height)       # that widens
        return ContactProblem(STEEL, bore, roller={"top": -0.05, rollers: 0}, axisymmetric=height is y)

    mesh = MakeStructured2DMesh(quads=True, nx=1, ny=2, mapping=lambda s, t: (1 + s, t))
    ring = Solve(Discretization(Upset(y, "bottom"), LDG(), mesh, order=2))
    quarter = Solve(Discretization(Upset(z, "bottom|xz|yz"), LDG(), QuarterRing(), order=2))
    assert 4 * quarter.Force("top")[2] == pytest.approx(ring.Force("top")[1], rel=0.01)
    assert 4 * quarter.normalforce == pytest.approx(ring.normalforce, rel=0.01)
    assert 4 * quarter.disc.unknowns > 50 * ring.disc.unknowns


def test_conjugate_gradients_take_as_many_steps_as_in_the_plane():
    """The levels are those of the section, and their matrices have the weight; also nearly incompressible."""
    for nu in (0.3, 0.49):
        steps = {}
        for axisymmetric in (False, True):
            problem = ContactProblem(HookeMaterial(E=100, nu=nu), Foundation("bottom", NormalCompliance(500)),
                                     dirichlet={"top": (0, -0.05)}, axisymmetric=axisymmetric)
            disc = Discretization(problem, InteriorPenalty(), RectangleMesh(8), inverse="iterative")
            load = np.random.default_rng(1).standard_normal(disc.space.ndof)
            assert np.linalg.norm(disc.Multiply(disc.SolveLinear(load)) - load) < 1e-9 * np.linalg.norm(load)
            steps[axisymmetric] = disc.inverse.iterations
        assert steps[True] <= 1.25 * steps[False]
    direct = Discretization(problem, InteriorPenalty(), RectangleMesh(8))
    np.testing.assert_allclose(Solve(disc).pressure, Solve(direct).pressure, rtol=1e-7)
