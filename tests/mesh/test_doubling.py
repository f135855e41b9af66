"""Nodes that are doubled along joints: the mesh, what is solved on it, and the uncut body in the limit."""

import numpy as np
import pytest
from bodies import LINE, Layers
from jointed import BODIES, MID, NU, P, Patch, Sheet
from netgen.geom2d import SplineGeometry
from ngsolve import CF, Integrate, Mesh

from ngdgc import (LDG, Conforming, ContactProblem, ContactSolution, CoulombFriction, Discretization, Foundation,
                   HookeMaterial, InteriorPenalty, Joint, NormalCompliance, ProblemError, Solve)
from ngdgc.contact.sides import Faces
from ngdgc.mesh.doubling import Doubled
from ngdgc.mesh.facets import Facets


@pytest.mark.parametrize("path", [LINE, LINE[1:5], LINE[3:]], ids=["whole", "inside", "half"])
def test_stiff_joint_is_no_joint(path):
    """Pressed and sheared within friction it jumps by P/K, and so does u change: H1 is that of the uncut body within 1/K.

    Discontinuous methods have a floor, what the penalty of their own facets does there: 1e-5 on this mesh.
    """
    mesh, data = Sheet(path=path), {"dirichlet": {"bottom": (0, 0)}, "traction": {"top": (3, -P)}}
    at = [(0.3, 0.8), (0.71, 0.71), (0.9, 0.3)]

    def Values(method, foundation):
        problem = ContactProblem(HookeMaterial(E=1000, nu=NU), foundation, **data)
        solution = Solve(Discretization(problem, method, mesh, order=2), tol=1e-12)
        return np.array([solution.At(*point) for point in at])

    away = Foundation("left", NormalCompliance(1), gap=1e3)
    for method, floor in ((Conforming(), 0), (LDG(), 1e-5), (InteriorPenalty(), 1e-5)):
        whole = Values(method, away)
        changes = [np.abs(Values(method, Joint("mid", NormalCompliance(K * 1000), friction=CoulombFriction(1))) - whole).max()
                   / np.abs(whole).max() for K in (1e4, 1e6, 1e8)]
        assert all(change < 2 / K + floor for change, K in zip(changes, (1e4, 1e6, 1e8)))
        assert changes[0] > 0.1 / 1e4       # and there is a joint


@pytest.mark.parametrize("mesh, vertices", [(BODIES[2], None), (Sheet(path=LINE), 7), (Sheet(path=LINE[1:5]), 2),
                                            (Sheet(path=LINE[3:]), 3), (BODIES[3], 4)],
                         ids=["layers", "whole", "inside", "half", "solid"])
def test_nodes_are_doubled_between_the_ends_of_a_joint(mesh, vertices):
    """Elements, names and volume are kept; the sides have the same points, opposite normals, and materials in their order."""
    facets = Facets(mesh, ["mid"])
    doubled = Doubled(facets)
    copies = doubled.mesh.nv - mesh.nv
    assert copies == (vertices or np.sum(np.abs(mesh.ngmesh.Coordinates()[:, 1] - MID) < 1e-9))
    assert doubled.mesh.ne == mesh.ne and list(doubled.mesh.GetBoundaries()) == list(mesh.GetBoundaries())
    assert Integrate(CF(1), doubled.mesh) == pytest.approx(Integrate(CF(1), mesh))
    assert doubled.component.max() == (0 if vertices in (2, 3) else 1)
    joint = Joint("mid", NormalCompliance(1))
    # Its ends, which do not open, are no contact points.
    problem = ContactProblem(HookeMaterial(E=1, nu=NU), joint)
    assert len(Discretization(problem, Conforming(), mesh).contact.weights) == copies
    first, second = Faces(doubled, joint, 4)
    assert first.coordinates == pytest.approx(second.coordinates) and first.normals == pytest.approx(-second.normals)
    assert first.weights == pytest.approx(second.weights)
    broken, beyond = Faces(facets, joint, 4)
    assert first.elements.tolist() == broken.elements.tolist() and second.elements.tolist() == beyond.elements.tolist()


def test_curved_bodies_stay_curved_where_nodes_are_doubled():
    geometry = SplineGeometry()
    p = [geometry.AppendPoint(*q) for q in [(0, 0), (1, 0), (1, 1), (0, 1)]]
    for a, b, name, sides in ((0, 1, "bottom", (1, 0)), (3, 0, "mid", (1, 2))):
        geometry.Append(["line", p[a], p[b]], bc=name, leftdomain=sides[0], rightdomain=sides[1])
    geometry.Append(["spline3", p[1], p[2], p[3]], bc="rim", leftdomain=1, rightdomain=0)
    q = [geometry.AppendPoint(*q) for q in [(-1, 0), (-1, 1)]]
    for a, b in ((p[3], q[1]), (q[1], q[0]), (q[0], p[0])):
        geometry.Append(["line", a, b], bc="left", leftdomain=2, rightdomain=0)
    mesh = Mesh(geometry.GenerateMesh(maxh=0.4)).Curve(3)
    doubled = Doubled(Facets(mesh, ["mid"])).mesh
    assert doubled.GetCurveOrder() == 3
    assert Integrate(CF(1), doubled) == pytest.approx(Integrate(CF(1), mesh), rel=1e-13)
    assert Integrate(CF(1), doubled) > 1.6


def test_solution_on_doubled_nodes_is_saved_with_the_mesh_that_was_given(tmp_path):
    problem, _ = Patch(2, 8.0, 0.0)
    disc = Discretization(problem, Conforming(), BODIES[2], order=2)
    solution = Solve(disc)
    assert disc.given is BODIES[2] and disc.mesh is not BODIES[2]
    solution.Save(tmp_path / "saved")
    loaded = ContactSolution.Load(tmp_path / "saved", problem)
    assert loaded.vector == pytest.approx(solution.vector, abs=1e-15)
    assert loaded.Force("mid", material="soft") == pytest.approx([8, -P]) == solution.Force("mid")


def test_mesh_that_was_given_must_stay_as_it_is():
    mesh = Layers(2)
    solution = Solve(Discretization(Patch(2, 8.0, 0.0)[0], Conforming(), mesh))
    mesh.Refine()
    with pytest.raises(ProblemError, match="the mesh was refined"):
        solution.gfu(0.5, 0.5)
