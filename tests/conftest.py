"""Things every test file uses."""

import os

# Processes side by side must not start threads of their own: theirs wait for each other busily.  Libraries read this once.
os.environ.update(NGS_NUM_THREADS="1", OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", MKL_NUM_THREADS="1")

import numpy as np
import pytest
from netgen.meshing import Element1D
from ngsolve import CF, GridFunction, x, y
from running import (pytest_collection_modifyitems, pytest_runtest_logstart, pytest_runtest_makereport,  # noqa: F401  hooks
                     pytest_terminal_summary, pytest_xdist_auto_num_workers)

from ngdgc import (LDG, BassiEtAl, BrezziEtAl, Conforming, ContactProblem, CoulombFriction, Discretization, Foundation,
                   HookeMaterial, InteriorPenalty, NestedNewtonSolver, NormalCompliance, TrescaFriction)
from ngdgc.cases import example_4_2
from ngdgc.cli import Main
from ngdgc.meshes import BoxMesh, RectangleMesh

METHODS = [InteriorPenalty(), InteriorPenalty(penalty=30), Conforming()]


ROWS = (InteriorPenalty, BassiEtAl, BrezziEtAl, LDG)
EIGHT = [row(form=form) for row in ROWS for form in ("edge", "lifting")]


@pytest.fixture(params=EIGHT, ids=[f"{method.name}-{method.form}" for method in EIGHT])
def eight(request):
    """The four methods in their two forms."""
    return request.param


@pytest.fixture(params=METHODS, ids=["ip-auto", "ip-30", "h1"])
def method(request):
    return request.param


def Example(stiffness=450.0, *, plane="strain", friction=1.0, **replacements):
    """Example 4.1 with some data replaced."""
    arguments = {"material": HookeMaterial(E=2000, nu=0.4, plane=plane),
                 "foundation": Foundation("bottom", NormalCompliance(stiffness), friction=TrescaFriction(friction), gap=0.05),
                 "dirichlet": {"right": CF((0, 0))}, "traction": {"left": CF((200 * (5 - y), -190))}, **replacements}
    return ContactProblem(**arguments)


def Pressed(foundation, mesh, u=(0.03, -0.05), *, method=InteriorPenalty(), order=1):
    """The solution of a block, E = 1000, nu = 0.3, pressed on its foundation by the displacement of its top."""
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), foundation, dirichlet={"top": CF(u)})
    return NestedNewtonSolver().Solve(Discretization(problem, method, mesh, order=order))


@pytest.fixture(scope="session")
def lifting():
    """Example 4.2: half of the bottom presses and slips."""
    return example_4_2.Main(n=8)


@pytest.fixture(scope="session")
def varying():
    """Two foundations, one with a stiffness that varies; separation, stick and slip."""
    return Pressed((Foundation("bottom", NormalCompliance(2000 * (1 + x)), friction=CoulombFriction(0.3)),
                    Foundation("right", NormalCompliance(300, exponent=0.5), gap=0.01, friction=TrescaFriction(2))),
                   RectangleMesh(6), order=2)


@pytest.fixture(scope="session")
def solid():
    """A block in space that leaves its foundation, sticks and slips."""
    return Pressed(Foundation("bottom", NormalCompliance(100), friction=CoulombFriction(0.4), gap=0.1 * x),
                   BoxMesh(2, cells="hex"), (0.05, 0.02, -0.04), method=LDG())


def AddSides(mesh, sides):
    """Named sides of a plane mesh of Netgen, {name: [(vertex, vertex), ...]}, counted from 0."""
    for name, edges in sides.items():
        region = mesh.AddRegion(name, dim=1)
        for first, second in edges:     # not all at once: in NGSolve 6.2.2604 they would have no region
            mesh.Add(Element1D(index=region, vertices=[first + 1, second + 1]))


def Interpolate(disc, displacement):
    """Coefficients (ndof,) of a polynomial that lies in the space."""
    function = GridFunction(disc.space)
    function.Set(displacement, bonus_intorder=4)
    return function.vec.FV().NumPy().copy()


def Residual(disc, vector, traction):
    """A u - f + T' W t on the free dofs, relative to the load."""
    residual = disc.Multiply(vector) - disc.load + disc.contact.Load(traction)
    free = np.array(list(disc.space.FreeDofs()))
    return np.abs(residual[free]).max() / np.abs(disc.load).max()


def SameZones(zones, points, exact):
    """Are zones (n,) at points (n, d) those of an exact solution?  At the end of a zone both sides are right."""
    step, box = 1e-3 * np.eye(points.shape[1])[0], (points.min(axis=0), points.max(axis=0))
    return bool(np.all(np.any([zones == exact.zones(np.clip(points + shift, *box)) for shift in (-step, step)], axis=0)))


def ExitCode(arguments):
    """The exit code of the command `ngdgc` with these arguments, a string, also where its parser ends the program."""
    try:
        return Main(arguments.split())
    except SystemExit as stop:
        return stop.code
