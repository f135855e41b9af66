"""What classes that break a contract are made of."""

import pytest
from ngsolve import CF

from ngdgc import (ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NormalCompliance, ProblemError)
from ngdgc.meshes import RectangleMesh


def Disc(method=None, mesh=None, held=True, **options):
    mesh = mesh or RectangleMesh(2)
    foundation = Foundation("bottom", NormalCompliance(100), friction=CoulombFriction(0.3))
    support = {"dirichlet": {"top": CF((0.01, 0, -0.02)[-mesh.dim:])}} if held else {"bodyforce": CF((0, 0, -1)[-mesh.dim:])}
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, **support)
    return Discretization(problem, method or InteriorPenalty(), mesh, **options)


def Refused(words, Check, *arguments, **options):
    with pytest.raises(ProblemError, match=words):
        Check(*arguments, **options)


class Wrong:
    """A Discretization with some members replaced."""

    def __init__(self, disc, **members):
        self.__dict__.update(members)
        self.disc = disc

    def __getattr__(self, name):
        return getattr(self.disc, name)
