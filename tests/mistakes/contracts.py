"""Objects that do not keep their contracts, as in `mistakes`; `test_conformance` has one for each question that is asked."""

from types import SimpleNamespace

from mistakes import Disc

from ngdgc.conformance import CheckInverse, CheckSolver
from ngdgc.linear.factorisations import Operator


def Unchanged(matrix, free, disc):
    """The identity is no inverse."""
    return SimpleNamespace(Solve=lambda load: load)


def Doubling(matrix, free, disc):
    """An inverse of another matrix, written over the one that was given."""
    matrix.AsVector().data = 2 * matrix.AsVector()
    return Operator(matrix.Inverse(free, inverse="sparsecholesky"), disc.mesh)


CONTRACTS = [
    (lambda _: Disc(inverse=Doubling).inverse, "inverse=Doubling | changes the matrix that it is given | work on a copy"),
    (lambda _: CheckInverse(lambda *made: 3, Disc()),
     "inverse=<lambda> makes 3 | has no Solve | return an object as contracts.Inverse describes it"),
    (lambda _: CheckSolver(SimpleNamespace(), Disc()), "solver SimpleNamespace | has no Solve | give it, as contracts.Solver"),
    (lambda _: CheckInverse(Unchanged, Disc()), "inverse=Unchanged | A x = b is to hold to 1e-10 | solve more accurately"),
    (lambda _: CheckSolver(SimpleNamespace(Solve=lambda disc: None), Disc()),
     "solver SimpleNamespace.Solve | raises TypeError | let it take a Discretization and callback")]
