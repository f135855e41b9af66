"""Things every test file uses."""

import os

# Processes side by side must not start threads of their own: theirs wait for each other busily.  Libraries read this once.
if "PYTEST_XDIST_WORKER" in os.environ:
    os.environ.update(NGS_NUM_THREADS="1", OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1", MKL_NUM_THREADS="1")

import numpy as np
import pytest
from netgen.meshing import Element1D
from ngsolve import CF, GridFunction, y

from ngdgc import (LDG, BassiEtAl, BrezziEtAl, Conforming, ContactProblem, Foundation, HookeMaterial, InteriorPenalty,
                   NormalCompliance, TrescaFriction)
from ngdgc.cli import Main

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
