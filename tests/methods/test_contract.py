"""Our own methods and forms keep their contracts, and one that does not is told which member is missing or wrong."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from broken import Disc, Refused, Wrong
from ngsolve import H1, GridFunction

from ngdgc import LDG, Conforming, Discretization, InteriorPenalty
from ngdgc.conformance import CheckForm, CheckMethod
from ngdgc.mesh.facets import Csr, Native
from ngdgc.meshes import RectangleMesh
from ngdgc.methods.registry import METHODS


@pytest.mark.slow
@pytest.mark.parametrize("name", METHODS)
def test_methods(name):
    CheckMethod(METHODS[name]())


@pytest.mark.slow
@pytest.mark.parametrize("cells", ["quad", "tet", "hex"])
def test_methods_on_other_cells(cells):
    for method in (InteriorPenalty(), LDG(form="lifting"), Conforming()):
        CheckMethod(method, cells=cells, order=2)


def Form(**members):
    """The form of a method with some members replaced."""
    disc = Disc()
    return Wrong(disc.form, **members), disc.space


def test_forms_and_methods_that_are_none():
    disc = Disc()
    CheckForm(*Form())
    matrix = Csr(disc.form.Norm())
    Refused("form SimpleNamespace has no .*Matrix, Norm, Prescribed", CheckForm, SimpleNamespace(), disc.space)
    Refused(r"Wrong.Matrix\(\) has shape \(3, 3\)", CheckForm, *Form(Matrix=lambda: Native(matrix[:3, :3])))
    Refused(r"Wrong.Matrix\(\) is not finite", CheckForm, *Form(Matrix=lambda: Native(np.nan * matrix)))
    Refused(r"Wrong.Norm\(\) is not symmetric", CheckForm, *Form(Norm=lambda: Native(matrix + 0.1 * np.abs(matrix).multiply(
        np.arange(48)[:, None] > np.arange(48)).tocsr())))
    Refused(r"Wrong.Norm\(\) is not positive", CheckForm, *Form(Norm=lambda: Native(-matrix)))
    Refused(r"Wrong.Prescribed\(\)\['top'\] has shape", CheckForm, *Form(Prescribed=lambda: {"top": np.zeros(3)}))
    Refused("method SimpleNamespace has no .*Form, ScalarSpace, Space", CheckMethod, SimpleNamespace())
    Refused("says that it is symmetric", CheckMethod, Wrong(METHODS["nipg"](), symmetric=True))
    tilted = InteriorPenalty()
    Refused("does not return an affine displacement", CheckMethod, Wrong(tilted, Form=lambda problem, *rest: tilted.Form(
        replace(problem, dirichlet={region: 2 * value for region, value in problem.dirichlet.items()}), *rest)))


def Answering(method, form=None, **answers):
    """A method that answers otherwise, or makes its form with other members."""
    if form:
        answers["Form"] = lambda *data: Wrong(made := method.Form(*data), **form(made))
    return Wrong(method, **answers)


def test_methods_that_do_not_answer_for_themselves():
    """Every question of the contract, answered wrongly; the wrappers themselves are no mistake."""
    ip, h1 = InteriorPenalty(), Conforming()
    CheckMethod(Answering(ip, form=lambda made: {}))
    for words, method in {
            "has symmetric = 'yes'; answer True or False": Answering(ip, symmetric="yes"),
            "IP says discontinuous = False, and its elements have no dofs": Answering(ip, discontinuous=False),
            "H1 says discontinuous = True, and its elements have some dofs": Answering(h1, discontinuous=True),
            "IP says that displacements on Gamma_D are not weak": Answering(ip, weak=False),
            "H1 says that displacements on Gamma_D are weak": Answering(h1, weak=True),
            "has no FluxFunction, operators; .* contracts.FluxForm": Answering(h1, conservative=True),
            "H1 says iterative = True, and is continuous": Answering(h1, iterative=True),
            "not return an affine displacement": Answering(METHODS["wopsip"](), form=lambda _: {"consistent": True})}.items():
        Refused(words, CheckMethod, method)


def test_all_of_gamma_d_is_held():
    """A space that forgets the second of two regions would solve another problem."""
    h1, mesh, end = Conforming(), RectangleMesh(2), {"top": (0, 0), "left": (0, 0)}
    problem = replace(Disc().problem, dirichlet=end)
    forgetful = Answering(h1, Space=lambda mesh, order, clamped: h1.Space(mesh, order, clamped.split("|")[0]))
    Refused("its space holds 6 of 10 dofs there", Discretization, problem, forgetful, mesh)
    assert Discretization(problem, Answering(h1), mesh).space.ndof == 18        # control


def test_fluxes_that_are_none():
    """Of the wrong size, without a region, not finite, without balance, and not those of FluxFunction."""
    ip = InteriorPenalty()

    def Fluxes(Change):
        return Answering(ip, form=lambda made: {"Fluxes": lambda gfu: {
            region: Change(flux) for region, flux in made.Fluxes(gfu).items()}})

    def Flux(Change):
        def FluxFunction(made, gfu):
            return Change(made.FluxFunction(gfu))
        return Answering(ip, form=lambda made: {"FluxFunction": lambda gfu: FluxFunction(made, gfu)})

    def Halved(function):
        function.vec.data = 0.5 * function.vec
        return function

    CheckMethod(Fluxes(np.copy))
    CheckMethod(Flux(lambda function: function))
    Refused("Fluxes.* has shape", CheckMethod, Fluxes(lambda flux: flux[:3]))
    Refused("Fluxes.* is not finite", CheckMethod, Fluxes(lambda flux: np.nan * flux))
    Refused("do not balance its elements", CheckMethod, Fluxes(lambda flux: 2 * flux))
    Refused("is .*; give a dictionary", CheckMethod, Answering(ip, form=lambda made: {"Fluxes": lambda gfu: [1]}))
    Refused("another by FluxFunction than by Fluxes", CheckMethod, Flux(Halved))
    Refused("FluxFunction has .* coefficients", CheckMethod, Flux(lambda function: GridFunction(H1(function.space.mesh))))
    Refused(r"Prescribed\(\)\[.*\] is not finite", CheckForm, *Form(Prescribed=lambda: {"top": np.full(48, np.nan)}))
    Refused("is None; give NGSolve's sparse matrix", CheckForm, *Form(Norm=lambda: None))
