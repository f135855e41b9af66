"""Mistakes with bodies of revolution, and what does not know them, as in `mistakes`."""

import numpy as np
from mistakes import SOFT, On
from ngsolve import CF
from ngsolve.meshes import MakeStructured2DMesh

from ngdgc import (LDG, AnisotropicMaterial, ContactProblem, Discretization, EstimateForce, Foundation, HookeMaterial,
                   RigidPunch, Solve, SolveAdaptive)
from ngdgc.export import Scene
from ngdgc.meshes import BoxMesh
from ngdgc.theory.consistency import ConsistencyVector

TWIST = np.zeros((6, 6))
TWIST[0, 4] = TWIST[4, 0] = 0.2     # sigma_rr of a shear in (r, theta)


def Ring(*, material=None, foundation=None, axisymmetric=True, inner=0.0, mesh=None, **changes):
    """A body of revolution on few elements, held above, with some data replaced."""
    held = {"dirichlet": {"top": (0, 0)}} | changes
    problem = ContactProblem(material or HookeMaterial(E=1, nu=0.3), foundation or On(), axisymmetric=axisymmetric, **held)
    return Discretization(problem, LDG(), mesh or MakeStructured2DMesh(nx=1, ny=1, mapping=lambda s, t: (inner + s, t)))


def Named(kind, value):
    return lambda _: Ring(**{kind: {"left": value}})


REVOLUTION = [
    (lambda _: Ring(axisymmetric="yes"), "axisymmetric is 'yes' | True for a body of revolution | give"),
    (lambda _: Ring(material=HookeMaterial(E=1, nu=0.3, plane="stress")),
     "material is HookeMaterial | hoop stress is not known | give a HookeMaterial with plane='strain'"),
    (lambda _: Ring(material=AnisotropicMaterial([[3, 1, 0], [1, 3, 0], [0, 0, 1]])),
     "material is AnisotropicMaterial | hoop stress is not known | give a HookeMaterial with plane='strain'"),
    (lambda _: Ring(dirichlet={"top": (0, 0, 0.1)}), "the data have 3 components | does not twist | give vectors (r, z)"),
    (lambda _: Ring(mesh=BoxMesh(1)),
     "the mesh has dimension 3 | a plane mesh of half of its section | leave axisymmetric out"),
    (lambda _: Ring(inner=-0.5), "the mesh reaches to r = -0.5 | beyond the axis x = 0 | give half of its section"),
    (lambda _: Ring(inner=1e-9), "corners of elements at r = 1e-09 | nearly on the axis | round their coordinates"),
    (lambda _: Ring(foundation=Foundation("left", SOFT)),
     "foundation region 'left' lies on the axis | nothing is given | leave it out"),
    (Named("roller", 0), "roller region 'left' lies on the axis | u_r = 0 by nature | leave it out"),
    (Named("traction", (0, 0)), "traction region 'left' lies on the axis | no part of its surface | leave it out"),
    (lambda _: Ring(foundation=On(punch=RigidPunch(force=(1, 2)))),
     "foundation 'bottom' | moves along the axis alone | give force=(None, F)"),
    (lambda _: Scene(Solve(Ring(axisymmetric=False)), turned=True), "turned is True | for a body of revolution | give True"),
    (lambda _: Ring(material=AnisotropicMaterial(np.diag([3.0, 3, 3, 1, 1, 1]) + TWIST)),
     "couples strains in the section with shear across it | the body would twist | let these be 0"),
    (lambda _: EstimateForce(Solve(Ring())), "EstimateForce | for bodies that are the mesh itself | compare with a finer mesh"),
    (lambda _: SolveAdaptive(Ring().problem, LDG(), Ring().mesh, tol=0.1, goal="force"),
     "SolveAdaptive with goal='force' | weight 2 pi r | compare"),
    (lambda _: Solve(Ring()).Moment("top"), "moments of a ring's forces | cancel all around | give point=(r, z)"),
    (lambda _: ConsistencyVector(Ring(), CF((0, 0))), "ConsistencyVector | weight 2 pi r | the body in space")]
