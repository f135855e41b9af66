"""What mistakes are made with, and what one is: a function of an empty folder that raises, with culprit | expectation | remedy.

The modules of this folder have one mistake for every error that the library raises.  `test_errors` makes them all, reads their
messages, and holds the lines that raised against the source.
"""

from types import SimpleNamespace

from netgen.geom2d import SplineGeometry
from ngsolve import CF, Mesh
from problems import Example

from ngdgc import (ContactProblem, Discretization, Foundation, FrictionLaw, HookeMaterial, InteriorPenalty, Joint,
                   NonsymmetricInteriorPenalty, NormalCompliance, TrescaFriction)
from ngdgc.meshes import BoxMesh, RectangleMesh

SOFT = NormalCompliance(450)


def Disc(method=None, *, n=2, mesh=None, order=1, **changes):
    """Example 4.1 on few elements, with some data replaced."""
    problem = Example(**{key: value for key, value in changes.items() if key not in ("assembly", "inverse")})
    options = {key: changes[key] for key in ("assembly", "inverse") if key in changes}
    return Discretization(problem, method or InteriorPenalty(), mesh or RectangleMesh(n), order=order, **options)


def On(**changes):
    """Foundation below with some data replaced."""
    return Foundation("bottom", **{"compliance": SOFT, **changes})


class Friction(FrictionLaw):
    """A law of a user's own, p_t = p_n."""

    def Bound(self, r, p):
        return 1.0 * p


def Lying(method=InteriorPenalty(), **answers):
    """A method whose members are others."""
    names = ("name", "discontinuous", "weak", "conservative", "iterative", "symmetric", "Space", "ScalarSpace", "Form")
    return SimpleNamespace(**{name: answers.get(name, getattr(method, name)) for name in names})


def Giving(**members):
    """A method whose form gives something else."""
    def Form(*arguments):
        form = InteriorPenalty().Form(*arguments)
        names = ("guarantee", "consistent", "lifted", "Matrix", "Norm", "Prescribed", "Fluxes", "operators", "FluxFunction")
        return SimpleNamespace(**{name: members.get(name, getattr(form, name)) for name in names})
    return Lying(Form=Form)


def Nonsymmetric():
    return Disc(NonsymmetricInteriorPenalty(), inverse="sparsecholesky")


def Inside():
    """A square with an interface inside."""
    geometry = SplineGeometry()
    geometry.AddRectangle((0, 0), (1, 1), bcs=["bottom", "right", "top", "left"], leftdomain=1)
    geometry.AddRectangle((0.3, 0.3), (0.7, 0.7), bc="interface", leftdomain=2, rightdomain=1)
    return Mesh(geometry.GenerateMesh(maxh=0.4))


def Jointed(method=None, region="interface", **changes):
    """A part of the body that a joint with friction holds."""
    return Disc(method, mesh=Inside(), foundation=[Joint(region, SOFT, friction=TrescaFriction(1), **changes)])


def Block():
    problem = ContactProblem(HookeMaterial(E=1, nu=0.3), Foundation("bottom", NormalCompliance(1)),
                             dirichlet={"top": CF((0, 0, 0))}, bodyforce=(0, 0, -1))
    return Discretization(problem, InteriorPenalty(), BoxMesh(2))


HELD = {"dirichlet": None, "traction": None, "foundation": On(friction=TrescaFriction(1)), "bodyforce": (0, -1)}
