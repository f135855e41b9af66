"""Objects that do not keep their contracts, as in `mistakes`.

`test_conformance` and `methods/test_contract` have one for each question that is asked.
"""

from types import SimpleNamespace

from mistakes import Disc, Giving, Lying
from ngsolve import L2

from ngdgc import Conforming
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
    (lambda _: Disc(Lying(ScalarSpace=lambda mesh, order: L2(mesh, order=3))),
     "method IP has a Space VectorL2 of 48 dofs | ScalarSpace L2 of 80 dofs | give NGSolve's VectorL2 or VectorH1"),
    (lambda _: Disc(Lying(weak=False)), "method IP says | its space holds 0 of 0 dofs there | or say weak = True"),
    (lambda _: Disc(Lying(Conforming(), weak=True)), "method H1 says | its space holds 6 dofs there | or say weak = False"),
    (lambda _: Disc(Lying(Conforming(), conservative=True)).form,
     "method H1 | has no FluxFunction, operators | contracts.FluxForm"),
    (lambda _: Disc(Giving(Matrix=lambda: None)).matrix,
     "the form of method IP | Matrix() of shape None | its space has (48, 48)"),
    (lambda _: Disc(inverse=Doubling).inverse, "inverse=Doubling | changes the matrix that it is given | work on a copy"),
    (lambda _: CheckInverse(lambda *made: 3, Disc()),
     "inverse=<lambda> makes 3 | has no Solve | return an object as contracts.Inverse describes it"),
    (lambda _: CheckSolver(SimpleNamespace(), Disc()), "solver SimpleNamespace | has no Solve | give it, as contracts.Solver"),
    (lambda _: CheckInverse(Unchanged, Disc()), "inverse=Unchanged | A x = b is to hold to 1e-10 | solve more accurately"),
    (lambda _: CheckSolver(SimpleNamespace(Solve=lambda disc: None), Disc()),
     "solver SimpleNamespace.Solve | raises TypeError | let it take a Discretization and callback")]
