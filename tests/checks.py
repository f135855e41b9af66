"""What several tests measure."""

import numpy as np
import scipy.linalg
from ngsolve import GridFunction, Integrate

from ngdgc.cli import Main
from ngdgc.mesh.facets import Csr


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


def Spectrum(disc):
    """Smallest eigenvalue of the form's symmetric part against its energy norm, by a dense computation."""
    matrix = Csr(disc.form.Matrix()).toarray()
    return scipy.linalg.eigh((matrix + matrix.T) / 2, Csr(disc.form.Norm()).toarray(), eigvals_only=True)[0]


def Random(space):
    function = GridFunction(space)
    function.vec.FV().NumPy()[:] = np.random.default_rng(3).standard_normal(space.ndof)
    return function


def Body(solution, material=".*"):
    """The body force (d,) in a part of the body."""
    mesh = solution.disc.mesh
    return np.array(Integrate(solution.disc.problem.bodyforce, mesh, definedon=mesh.Materials(material)))
