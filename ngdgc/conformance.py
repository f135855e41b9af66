"""Does an object keep its contract?  One function for each of `contracts`, which names the member that is missing or wrong.

Each runs an object of your own through what is asked of ours, on a problem of your choice, and returns nothing; ProblemError
says what is wrong.  That nothing is found is no proof.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from ngsolve import VOL, GridFunction

from . import contracts
from .contact.graph import Distance
from .contracts import Array
from .discretization import Discretization
from .exact import AffinePatch
from .exceptions import ProblemError
from .linear.outside import Made, OutsideInverse
from .mesh.facets import Csr, Free, VolumePoints
from .meshes import UnitMesh
from .problem.foundation import Foundation
from .problem.hypotheses import CheckLaws, LawReport
from .solution.history import Step
from .solution.resultants import BALANCE, ElementImbalance
from .solution.solution import ContactSolution
from .tools.calls import ByKeyword
from .tools.kinds import Short
from .tools.names import NameOf

ROUNDOFF = 1e-9     # relative, of what holds exactly
SYMMETRIC = 1e-7    # relative asymmetry of an inverse whose solutions are accurate
ITERATED = 1e-5     # relative error of conjugate gradients
LAW = 1e-6          # law residual of a solution that counts as converged


def _Ask(holds: Any, culprit: str, remedy: str) -> None:
    if not holds:
        raise ProblemError(f"{culprit}; {remedy}")


def _AskMembers(given: Any, contract: Any, word: str) -> None:
    missing = contracts.Missing(given, contract)
    _Ask(not missing, f"{word} {NameOf(given)} has no {', '.join(missing)}",
         f"give it, as contracts.{contract.__name__} describes it")


def _Same(first: Any, second: Any, tol: float = ROUNDOFF) -> bool:
    """Are two arrays the same up to a part of their size?  A NaN is not."""
    first, second = np.asarray(first), np.asarray(second)
    size = max(np.abs(first).max(initial=0), np.abs(second).max(initial=0))
    return bool(first.shape == second.shape and np.abs(first - second).max(initial=0) <= tol * size)


def _Loads(disc: Any) -> Array:
    """Three loads (3, ndof) that nothing distinguishes, zero where dofs are not free."""
    return np.random.default_rng(1).standard_normal((3, disc.space.ndof)) * Free(disc.space)


@ByKeyword
def CheckInverse(inverter: Any, disc: Any) -> None:
    """What is given as inverse= solves with the matrix of a Discretization, symmetrically if that is, and again.

    A second inverse, made of the double matrix, must leave the first one as it is; an inverse that `iterates` must take fewer
    steps for a larger tolerance and count them.

    >>> from ngdgc import *
    >>> from ngdgc.conformance import CheckInverse
    >>> from ngdgc.exact import AffinePatch
    >>> from ngdgc.linear.factorisations import Factorisation
    >>> from ngdgc.meshes import RectangleMesh
    >>> CheckInverse(Factorisation("umfpack"), Discretization(AffinePatch("slip").problem, LDG(), RectangleMesh(2)))
    """
    _Ask(callable(inverter), f"inverse {Short(inverter)} cannot be called",
         "give a function or class that makes an inverse of a matrix, its free dofs and the Discretization")
    name, matrix, iterates = NameOf(inverter), disc.matrix, bool(getattr(inverter, "iterates", False))
    made = Made(inverter, matrix, disc)
    made = made.inverse if isinstance(made, OutsideInverse) else made
    b, c, _ = loads = _Loads(disc)
    watched = OutsideInverse(name, made, matrix, disc)
    if disc.symmetric:
        x, y = (watched.Unchecked(load) for load in (b, c))
        wrong = abs(b @ y - c @ x) > SYMMETRIC * np.linalg.norm(b) * np.linalg.norm(y)     # False if not finite
        _Ask(not wrong, f"inverse={name} is not symmetric, as the matrix is",
             "undo every step by its adjoint, or solve more accurately")
    before = [watched.Solve(load) for load in loads]
    double = matrix.CreateMatrix()
    double.AsVector().data = 2 * matrix.AsVector()
    half = OutsideInverse(name, Made(inverter, double, disc), double, disc)
    _Ask(_Same(2 * half.Solve(b), before[0], SYMMETRIC) and _Same(watched.Solve(b), before[0], SYMMETRIC),
         f"inverse={name} solves otherwise after another inverse was made", "keep what belongs to one matrix in the object")
    given = b.copy()
    made.Solve(given)
    _Ask(np.array_equal(given, b), f"inverse={name}: Solve changes the load that it is given", "work on a copy")
    if iterates:
        counts = [made.iterations]
        for tol in (1e-2, 1e-8):
            watched.Solve(b, tol=tol, start=0 * b)
            counts.append(made.iterations)
        few, many = np.diff(counts)
        _Ask(0 < few < many, f"inverse={name} takes {few} steps to 1e-2 and {many} to 1e-8",
             "iterate to the tolerance that is given, and count all steps in iterations")


@ByKeyword
def CheckPreconditioner(preconditioner: Any, disc: Any) -> None:
    """What is given as preconditioner= is linear, symmetric and positive definite on the matrix of a Discretization."""
    _Ask(callable(preconditioner), f"preconditioner {Short(preconditioner)} cannot be called",
         "give a function or class of a matrix, its free dofs and the Discretization")
    name = NameOf(preconditioner)
    made = preconditioner(disc.matrix, disc.space.FreeDofs(), disc)
    _AskMembers(made, contracts.Preconditioner, f"what {name} makes,")
    source, target = disc.matrix.CreateColVector(), disc.matrix.CreateRowVector()

    def Apply(vector: Array) -> Array:
        source.FV().NumPy()[:] = vector
        made.Mult(source, target)
        _Ask(np.array_equal(source.FV().NumPy(), vector), f"preconditioner {name}: Mult(b, x) changes b", "write into x alone")
        return np.array(target.FV().NumPy())

    b, c, _ = loads = _Loads(disc)
    x, y = Apply(b), Apply(c)
    _Ask(_Same(Apply(b + 2 * c), x + 2 * y), f"preconditioner {name} is not linear, or not finite",
         "take a fixed number of steps from zero")
    _Ask(abs(b @ y - c @ x) <= ROUNDOFF * np.linalg.norm(b) * np.linalg.norm(y), f"preconditioner {name} is not symmetric",
         "let every step back be the adjoint of one forth")
    _Ask(all(load @ Apply(load) > 0 for load in loads), f"preconditioner {name} is not positive definite",
         "damp its steps, and treat every dof")


@ByKeyword
def CheckLinearProblem(problem: Any) -> None:
    """What stands in for a Discretization in Newton's method: shapes, trace and its adjoint, products, inverse, counters."""
    _AskMembers(problem, contracts.LinearProblem, "linear problem")
    name, contact, size = NameOf(problem), problem.contact, problem.matrix.height
    vectors = np.random.default_rng(1).standard_normal((2, size))
    traction = np.random.default_rng(2).standard_normal(contact.normals.shape)
    _Ask(np.shape(problem.load) == (size,), f"the load of {name} has shape {np.shape(problem.load)}",
         f"give an array ({size},)")
    _Ask(np.shape(problem.motions)[1:] == (size,), f"the motions of {name} have shape {np.shape(problem.motions)}",
         f"give rows of {size} coefficients, or an array (0, {size})")
    _Ask(_Same(problem.Multiply(vectors[0]), Csr(problem.matrix) @ vectors[0]), f"{name}.Multiply is not the matrix",
         "multiply with it")
    work = np.einsum("n,nd,nd", contact.weights, traction, contact.Displacement(vectors[0]))
    _Ask(_Same(vectors[0] @ contact.Load(traction), work), f"contact.Load of {name} is not the adjoint of contact.Displacement",
         "give both the trace on the same space")
    if problem.unresisted:
        return
    before = problem.solves
    x, y = (problem.ApplyInverse(problem.inverse, vector) for vector in vectors)
    _Ask(problem.solves == before + 2, f"{name} counts {problem.solves - before} applications of two", "count each in solves")
    # y vanishes where dofs are not free.
    _Ask(_Same(y @ problem.Multiply(x), y @ vectors[0], SYMMETRIC), f"{name}.inverse is not that of its matrix",
         "make it with Factorise(matrix)")


@ByKeyword
def CheckSpaceNumbering(space: Any, scalar: Any) -> None:
    """V_h numbers its dofs by components: those of an element are those of the scalar space, shifted by ndof for each."""
    dim, mesh = space.mesh.dim, space.mesh
    _Ask(space.ndof == dim * scalar.ndof, f"the space has {space.ndof} dofs, its component {scalar.ndof}",
         f"give a space of {dim} equal components")
    for element in mesh.Elements(VOL):
        own = np.asarray(scalar.GetDofNrs(element))
        wanted = np.concatenate([own + i * scalar.ndof for i in range(dim)])
        _Ask(np.array_equal(space.GetDofNrs(element), wanted), f"element {element.nr} has the dofs {space.GetDofNrs(element)}",
             f"{wanted.tolist()} is expected, all of one component after the other; give NGSolve's VectorL2 or VectorH1")


@ByKeyword
def CheckForm(form: Any, space: Any) -> None:
    """B_h before assembly: a finite matrix on the space, a norm that is symmetric and positive, loads and fluxes on it."""
    _AskMembers(form, contracts.Form, "form")
    name, shape = NameOf(form), (space.ndof, space.ndof)
    vectors = np.random.default_rng(1).standard_normal((2, space.ndof)) * Free(space)
    for member in ("Matrix", "Norm"):
        matrix = getattr(form, member)()
        _Ask(hasattr(matrix, "CSR"), f"{name}.{member}() is {Short(matrix)}", "give NGSolve's sparse matrix")
        matrix = Csr(matrix)
        _Ask(matrix.shape == shape, f"{name}.{member}() has shape {matrix.shape}", f"make it on the space, {shape}")
        _Ask(np.all(np.isfinite(matrix.data)), f"{name}.{member}() is not finite", "look for a division by zero")
    u, v = vectors
    asymmetry, size = abs(u @ (matrix @ v) - v @ (matrix @ u)), abs(u) @ (abs(matrix) @ abs(v))
    _Ask(asymmetry <= ROUNDOFF * size, f"{name}.Norm() is not symmetric", "give the matrix of a scalar product")
    _Ask(u @ (matrix @ u) > 0, f"{name}.Norm() is not positive", "give the energy norm of strains and jumps")
    gfu = GridFunction(space)
    gfu.vec.FV().NumPy()[:] = v
    for member, found in (("Prescribed()", form.Prescribed()), ("Fluxes(gfu)", form.Fluxes(gfu))):
        _Ask(isinstance(found, dict), f"{name}.{member} is {Short(found)}", f"give a dictionary of arrays ({space.ndof},)")
        for region, load in found.items():
            _Ask(np.shape(load) == shape[:1], f"{name}.{member}[{region!r}] has shape {np.shape(load)}",
                 f"give an array ({space.ndof},)")
            _Ask(np.all(np.isfinite(load)), f"{name}.{member}[{region!r}] is not finite", "look for a division by zero")


@ByKeyword
def CheckMethod(method: Any, *, cells: str = "triangle", order: int = 1) -> None:
    """A method has its members, its dofs are numbered as is asked, its form is one, symmetric if it says so, and a body solved.

    With terms of consistency the solution is the affine displacement of `exact.AffinePatch` to round-off.  Of a conservative
    method every element balances, and forces on a region are the same by both kinds of fluxes; of an iterative one conjugate
    gradients find what a factorisation finds.
    cells : of a mesh of the unit square or cube, as for `meshes.RectangleMesh` or `meshes.BoxMesh`
    """
    _AskMembers(method, contracts.Method, "method")
    for answer in ("discontinuous", "weak", "conservative", "iterative", "symmetric"):
        _Ask(isinstance(getattr(method, answer), bool), f"method {NameOf(method)} has {answer} = "
             f"{Short(getattr(method, answer))}", "answer True or False")
    mesh = UnitMesh(2, cells)
    exact = AffinePatch("slip", dim=mesh.dim)
    disc = Discretization(exact.problem, method, mesh, order=order)
    CheckSpaceNumbering(disc.space, method.ScalarSpace(mesh, order))
    shared = sum(len(disc.space.GetDofNrs(element)) for element in mesh.Elements(VOL)) > disc.space.ndof
    _Ask(shared != method.discontinuous, f"method {NameOf(method)} says discontinuous = {method.discontinuous}, and its "
         f"elements have {'some' if shared else 'no'} dofs in common", "answer for its space")
    CheckForm(disc.form, disc.space)
    b, c, _ = _Loads(disc)
    work = b @ disc.Multiply(c), c @ disc.Multiply(b)
    _Ask(not method.symmetric or _Same(*work, 1e-6),
         f"method {NameOf(method)} says that it is symmetric, and its matrix is not",
         "say symmetric = False, or add the adjoint of what is missing")
    solution = disc.Solve(coarser=())
    consistent = getattr(disc.form, "consistent", True) or getattr(disc.form, "lifted", False)
    points = VolumePoints(mesh, 2)
    _Ask(not consistent or _Same(solution.gfu(points), exact.displacement(points), SYMMETRIC),
         f"method {NameOf(method)} does not return an affine displacement",
         "look for a term that is missing, or wrong by a sign")
    if method.conservative:
        _CheckFluxes(solution)
    _Ask(method.discontinuous or not method.iterative, f"method {NameOf(method)} says iterative = True, and is continuous",
         "say iterative = False")
    if method.iterative and method.symmetric:
        other = Discretization(exact.problem, method, mesh, order=order, inverse="iterative")
        _Ask(_Same(other.SolveLinear(b), disc.SolveLinear(b), ITERATED), f"method {NameOf(method)} says iterative = True, and "
             "conjugate gradients find another solution than a factorisation", "say iterative = False")


def _CheckFluxes(solution: Any) -> None:
    """Of a conservative method."""
    name, form = NameOf(solution.disc.method), solution.disc.form
    size, wanted = form.FluxFunction(solution.gfu).space.ndof, form.operators.facetspace.ndof
    _Ask(size == wanted, f"method {name}: FluxFunction has {size} coefficients, {wanted} are expected",
         "make it with operators.facetspace")
    _Ask(np.all(np.abs(ElementImbalance(solution)) <= BALANCE), f"method {name} says conservative = True, and Fluxes of its "
         "form do not balance its elements", "say conservative = False, or look for a term that is missing in Fluxes")
    for resultant in solution.Resultants():
        if resultant.kind == "dirichlet":
            _Ask(_Same(solution.Force(resultant.region), resultant.force, SYMMETRIC), f"method {name}: the force on "
                 f"{resultant.region!r} is another by FluxFunction than by Fluxes", "give the same flux in both")


@ByKeyword
def CheckLaw(compliance: Any, friction: Any = None) -> LawReport:
    """Laws of contact have members, signs and derivatives as is asked; `CheckLaws` reports what holds of (2.13)."""
    _AskMembers(compliance, contracts.Compliance, "compliance law")
    if friction is not None:
        _AskMembers(friction, contracts.Friction, "friction law")
    # The constructor compares derivatives with differences, and looks at signs.
    Foundation("boundary", compliance, friction=friction)
    return CheckLaws(compliance, friction)


@ByKeyword
def CheckSolver(solver: Any, disc: Any) -> None:
    """A solver returns the ContactSolution of a Discretization, in balance and on the law, and tells every step."""
    _AskMembers(solver, contracts.Solver, "solver")
    name = NameOf(solver)
    steps: list[Step] = []
    try:
        solution = solver.Solve(disc, callback=steps.append)
    except TypeError as error:
        raise ProblemError(f"solver {name}.Solve(disc, callback=...) raises TypeError ({error}); let it take a Discretization "
                           "and callback") from error
    _Ask(isinstance(solution, ContactSolution), f"solver {name} returns {Short(solution)}", "return a ContactSolution")
    _Ask(solution.converged, f"solver {name} returns a solution that says it is not converged", "raise NotConvergedError")
    contact = disc.contact
    law = Distance(contact, solution.displacement, solution.traction).distance.max(initial=0)
    _Ask(law <= LAW, f"solver {name} returns tractions that are not on the law: the distance is {law:.1e}", "iterate longer")
    balance = solution.EquilibriumResidual()
    _Ask(balance <= BALANCE, f"solver {name} returns a displacement that is not in balance: A u - f + T' W t is {balance:.1e}",
         "solve A u = f - T' W t with the last traction")
    _Ask(len(steps) >= len(solution.history) and steps, f"solver {name} calls callback {len(steps)} times for "
         f"{len(solution.history)} steps", "call it with every Step of the history")
