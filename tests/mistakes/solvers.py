"""Mistakes in the inverses of matrices and in solvers, as in `mistakes`."""

from contextlib import contextmanager
from types import SimpleNamespace
from unittest.mock import patch

import numpy as np
import psutil
import scipy.sparse as sp
from mistakes import Block, Disc, Nonsymmetric
from ngsolve import BilinearForm, dx
from problems import Example

from ngdgc import Conforming, Discretization, EstimateContraction, NestedNewtonSolver, SemismoothNewtonSolver, UzawaSolver
from ngdgc.linear import choice as inverses
from ngdgc.mesh.facets import Csr, Native
from ngdgc.linear.conjugategradients import ConjugateGradients, IterativeInverse
from ngdgc.linear.factorisations import Operator
from ngdgc.meshes import BoxMesh


@contextmanager
def Memory(available):
    with patch.object(psutil, "virtual_memory", return_value=SimpleNamespace(available=available)):
        yield


def Interrupted(number):
    """Ctrl-C at an iteration, or before the first."""
    def Stop(step):
        if step.number == number:
            raise KeyboardInterrupt

    disc = Disc()
    if number == 0:
        with patch.object(disc, "FreeSolution", side_effect=KeyboardInterrupt):
            UzawaSolver().Solve(disc)
    UzawaSolver().Solve(disc, callback=Stop)


def Unbalanced():
    """Cholesky's factorisation of an unsymmetric matrix."""
    disc = Disc()
    u, v = disc.space.TnT()
    disc.Add(BilinearForm(3000 * (u[0] * v[1] - u[1] * v[0]) * dx))
    with patch.object(Discretization, "symmetric", True):
        SemismoothNewtonSolver().Solve(disc)


def WithoutMkl():
    with patch.object(inverses, "HasPardiso", return_value=False):
        return Disc(inverse="pardisospd").inversekind


def TooLarge(**options):
    disc = Disc(**options)
    assert disc.matrix.height
    with Memory(1000):
        return disc.inverse


def Indefinite(disc):
    return IterativeInverse(disc, Native(Csr(disc.matrix) - 10 * sp.eye(disc.space.ndof))).Solve(disc.load)


def Spoilt(Change):
    """An inverse of a user's own."""
    def Own(matrix, free, disc):
        inverse = Operator(matrix.Inverse(free, inverse="sparsecholesky"), disc.mesh)
        return SimpleNamespace(Solve=lambda load: Change(inverse.Solve(load)))
    return Own


def First(inverse, method=None):
    """The first step with an inverse."""
    disc = Disc(method, inverse=inverse)
    return disc.SolveLinear(disc.load)


def Backwards(disc):
    """Conjugate gradients with a preconditioner that is not positive definite."""
    def Minus(matrix, free, disc):
        return SimpleNamespace(Mult=lambda b, x: x.FV().NumPy().__setitem__(slice(None), -b.FV().NumPy()))
    return IterativeInverse(disc, disc.matrix, preconditioner=Minus).Solve(disc.load)


SOLVERS = [
    (lambda _: EstimateContraction(Disc(), np.zeros(4), step=-1), "step is -1 | at some point | give numbers >= 0"),
    # Inverses.
    (lambda _: Disc(inverse="lu").inversekind, "inverse is 'lu' | auto, sparsecholesky | choose"),
    (lambda _: Disc(Conforming(), inverse="iterative").inversekind,
     "inverse='iterative' is for discontinuous methods | H1 is none | take inverse='auto'"),
    (lambda _: Disc().Response(np.ones(3)), "traction has shape (3,) | at the contact points | give one"),
    (lambda _: Disc().FactoriseSum(np.ones(3)), "what is added to the matrix is | a sparse matrix of scipy | such as"),
    (lambda _: Disc().Multiply(np.ones(3)), "a vector of shape (3,) is given | coefficients of a function in the space | give"),
    (lambda _: Nonsymmetric().inversekind, "inverse='sparsecholesky' | is for symmetric matrices | take inverse='auto'"),
    (lambda _: Unbalanced(), "inverse='sparsecholesky' | did not solve the linear equations | another inverse"),
    (lambda _: WithoutMkl(),
     "inverse='pardisospd' | needs the library MKL | install them, pip install --upgrade ngdgc[mkl] ngsolve"),
    (lambda _: TooLarge(), "the factors of 48 unknowns | GB are free | take inverse='iterative'"),
    (lambda _: IterativeInverse(Disc(Conforming()), None),
     "H1 is none | a symmetric discontinuous method | take inverse='auto'"),
    (lambda _: IterativeInverse(Block(), Block().matrix).Solve(np.full(192 * 3, np.nan)),
     "the load | is not finite | look for a division"),
    (lambda _: IterativeInverse(Block(), Block().matrix, maxiter=2).Solve(Block().load),
     "conjugate gradients came to | instead of 1.0e-08 in 2 steps | take inverse='sparsecholesky'"),
    (lambda _: Indefinite(Block()),
     "the matrix is not positive definite | nothing holds the body, or the penalty is too small | add dirichlet"),
    (lambda _: ConjugateGradients(preconditioner="ilu"),
     "preconditioner is 'ilu' | of the matrix, its free dofs | give a function"),
    (lambda _: Backwards(Block()), "Minus is not positive definite | it must be, and symmetric | take another one"),
    # Inverses from outside.
    (lambda _: First(lambda matrix: 3), "inverse=<lambda> raises TypeError | must return an object with Solve(load) | mend it"),
    (lambda _: First(lambda matrix, free, disc: 3), "inverse=<lambda> makes 3 | which has no Solve | return an object"),
    (lambda _: First(Spoilt(lambda x: 1 / 0)), "inverse=Own: Solve raises ZeroDivisionError | must return one | mend it"),
    (lambda _: First(Spoilt(lambda x: x[:3])), "inverse=Own: Solve returns shape (3,) | real numbers, an array (48,) | give"),
    (lambda _: First(Spoilt(lambda x: np.nan * x)),
     "inverse=Own: Solve returns numbers that are not finite | for a matrix that is singular | take inverse='auto'"),
    (lambda _: First(Spoilt(lambda x: x + 1), Conforming()),
     "inverse=Own: Solve returns values at dofs that are not free | free dofs alone | make them 0"),
    (lambda _: First(Spoilt(lambda x: 1.01 * x)), "inverse=Own: Solve | A x = b is to hold to 1e-10 | solve more accurately"),
    # Solvers.
    (lambda _: UzawaSolver(normal="both"), "normal is 'both' | 'explicit' or 'implicit' | choose"),
    (lambda _: UzawaSolver(acceleration="aitken"), "acceleration is 'aitken' | None or 'anderson' | choose"),
    (lambda _: UzawaSolver(rho="adaptive"), "rho is 'adaptive' | for normal='implicit' without acceleration | take rho='auto'"),
    (lambda _: UzawaSolver(rho=0), "rho is 0 | 'auto', a positive number | give"),
    (lambda _: UzawaSolver(tol=0), "tol is 0 | a number between 0 and 1 | give"),
    (lambda _: UzawaSolver(maxiter=0), "maxiter is 0 | a positive integer | give"),
    (lambda _: UzawaSolver().Solve(Example()),
     "disc is ContactProblem | Discretization(problem, method, mesh, order=1) | give"),
    (lambda _: SemismoothNewtonSolver(tol=2), "tol is 2 | a number between 0 and 1 | give"),
    (lambda _: SemismoothNewtonSolver(maxiter=1.5), "maxiter is 1.5 | a positive integer | give"),
    (lambda _: SemismoothNewtonSolver().Solve(None), "disc is None | Discretization(problem, method, mesh, order=1) | give"),
    (lambda _: SemismoothNewtonSolver().Solve(Disc(), start=(1, 2)),
     "start is (1, 2) | at the contact points, both (4, 2) and finite | give the pair of displacement"),
    (lambda _: SemismoothNewtonSolver().Solve(Disc(), start=(np.zeros((4, 2)), np.zeros(4))),
     "start has shapes [(4, 2), (4,)] | at the contact points, both (4, 2) and finite | give the pair of displacement"),
    (lambda _: Disc().Solve(callback="print"), "callback is 'print' | a function of a Step | such as print"),
    (lambda _: NestedNewtonSolver(coarser=[4]), "coarser is [4] | a sequence of ngsolve.Mesh, coarse ones first | give"),
    (lambda _: NestedNewtonSolver().Solve(None), "disc is None | Discretization(problem, method, mesh, order=1) | give"),
    (lambda _: NestedNewtonSolver(coarser=[BoxMesh(1)]).Solve(Disc()),
     "coarser: the mesh has dimension 3 | have 2 | give both"),
    (lambda _: Interrupted(3), "interrupted | after 3 iterations | the last iterate is its attribute solution"),
    (lambda _: Interrupted(0), " |  | ")]
