"""Copies: errors and problems go to other processes, solutions say how they do."""

import copy
import multiprocessing
import pickle

import numpy as np
import pytest
from ngsolve import CF, Parameter, x
from problems import Pressed

from ngdgc import (LDG, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial, NormalCompliance,
                   NotConvergedError, ProblemError, Solve, SolveInterrupted, UzawaSolver)
from ngdgc.meshes import RectangleMesh

COPIES = [copy.copy, copy.deepcopy, lambda thing: pickle.loads(pickle.dumps(thing))]


def Problem():
    foundation = Foundation("bottom", NormalCompliance(300 * (1 + x)), friction=CoulombFriction(0.3), gap=0.01 * Parameter(2))
    return ContactProblem(HookeMaterial(E=2000, nu=0.3), foundation, dirichlet={"top": CF((0.05, -0.1))},
                          roller={"left": 0}, traction={"right": (0, -10 * x)}, bodyforce=(3, 0))


def Study(maxiter):
    """What a process of a pool does, on two elements."""
    return UzawaSolver(maxiter=maxiter).Solve(Discretization(Problem(), LDG(), RectangleMesh(1))).normalforce


@pytest.fixture(scope="module")
def failed():
    with pytest.raises(NotConvergedError) as failure:
        Study(2)
    return failure.value


@pytest.mark.parametrize("Copy", COPIES, ids=["copy", "deepcopy", "pickle"])
def test_errors_keep_message_history_and_arrays(Copy, failed):
    for error in (ProblemError("E is -1"), failed, SolveInterrupted(failed.solution)):
        found = Copy(Copy(error))
        assert type(found) is type(error) and str(found) == str(error)
        if not isinstance(error, ProblemError):
            kept, solution = found.solution, error.solution
            assert np.array_equal(kept.vector, solution.vector) and np.array_equal(kept.traction, solution.traction)
            assert kept.history == solution.history and not kept.converged and kept.solver == solution.solver
            # Arrays of its own: what happens to the solution does not reach the copy.
            assert kept.vector is not solution.vector and kept.history is not solution.history
    assert Copy(failed).contraction == failed.contraction and Copy(failed).history == failed.history


@pytest.mark.slow
@pytest.mark.parametrize("Copy", COPIES, ids=["copy", "deepcopy", "pickle"])
def test_problems_are_the_same_problem(Copy):
    mesh = RectangleMesh(2)
    force = Solve(Discretization(Problem(), LDG(), mesh)).normalforce
    found = Copy(Problem())
    assert repr(found) == repr(Problem())
    assert Solve(Discretization(found, LDG(), mesh)).normalforce == pytest.approx(force, 1e-12)
    other = ContactProblem(found.material, found.foundation, dirichlet={"top": CF((0.05, -0.2))})       # control
    assert Solve(Discretization(other, LDG(), mesh)).normalforce > 1.5 * force


@pytest.mark.parametrize("Copy", COPIES, ids=["copy", "deepcopy", "pickle"])
def test_solutions_and_discretizations_say_what_to_take(Copy):
    solution = Pressed(Foundation("bottom", NormalCompliance(100)), RectangleMesh(1))
    with pytest.raises(ProblemError, match="take Save"):
        Copy(solution)
    with pytest.raises(ProblemError, match="make another one"):
        Copy(solution.disc)
    assert np.array_equal(Copy(solution.traction), solution.traction)       # control: its arrays can be copied


@pytest.mark.slow
def test_a_pool_of_processes_passes_errors_on():
    """A new interpreter for each process: nothing is inherited."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        with pytest.raises(NotConvergedError, match="too slowly") as failure:
            pool.apply_async(Study, (2,)).get(timeout=60)
        assert len(failure.value.history) == 2
        assert pool.apply_async(Study, (1000,)).get(timeout=60) > 0         # control: the process goes on
