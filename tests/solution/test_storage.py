"""A saved solution is the solution, on straight and on curved meshes; a wrong folder or problem is named."""

import json

import numpy as np
import pytest
from bodies import Plate
from problems import Example

from ngdgc import (Conforming, ContactProblem, ContactSolution, CoulombFriction, Discretization, Foundation,
                   HookeMaterial, NormalCompliance, ProblemError, UzawaSolver)
from ngdgc.meshes import RectangleMesh

PLATE = ContactProblem(HookeMaterial(E=1000, nu=0.3), Foundation("hole", NormalCompliance(50), friction=CoulombFriction(0.2)),
                       dirichlet={"outer": (0.1, 0.05)})


@pytest.mark.slow
@pytest.mark.parametrize("problem, mesh", [(Example(), RectangleMesh(4)), (PLATE, Plate())], ids=["square", "curved"])
def test_saved_and_loaded_solutions_agree(problem, mesh, method, tmp_path):
    solution = UzawaSolver().Solve(Discretization(problem, method, mesh, order=2))
    solution.Save(tmp_path / "kept")
    loaded = ContactSolution.Load(tmp_path / "kept", problem)
    assert np.array_equal(loaded.vector, solution.vector) and np.array_equal(loaded.traction, solution.traction)
    assert loaded.history == solution.history and loaded.converged and loaded.solver == solution.solver
    assert loaded.disc.method == method and loaded.disc.mesh.GetCurveOrder() == mesh.GetCurveOrder()
    # Netgen's files keep curved geometry to about ten digits, its normals at the ends of facets, which are points of H1, to
    # eight, straight meshes exactly.
    assert loaded.energy == pytest.approx(solution.energy, rel=1e-8)
    assert loaded.pressure == pytest.approx(solution.pressure, rel=1e-8 if method.discontinuous else 3e-8)
    assert loaded.Report().splitlines()[:8] == solution.Report().splitlines()[:8]
    assert solution.normalforce > 0.1


def test_summary_is_plain_json(method):
    solution = UzawaSolver().Solve(Discretization(Example(), method, RectangleMesh(2), order=1))
    numbers = json.loads(json.dumps(solution.ToJSON()))
    assert numbers["converged"] is True and numbers["elastic_energy"] == solution.energy
    assert numbers["zones"] == solution.ZoneLengths()
    assert ("element_imbalance" in numbers) == method.discontinuous


def test_loading_what_is_not_there_or_does_not_fit(method, tmp_path):
    with pytest.raises(ProblemError, match="holds no saved solution"):
        ContactSolution.Load(tmp_path / "nowhere", Example())
    solution = UzawaSolver().Solve(Discretization(Example(), method, RectangleMesh(2), order=1))
    solution.Save(tmp_path)
    other = Example(foundation=Foundation("top", NormalCompliance(1)))
    with pytest.raises(ProblemError, match="another problem: its points differ"):
        ContactSolution.Load(tmp_path, other)
    for changes, name in (({"plane": "stress"}, "energies"), ({"stiffness": 300.0}, "pressures"), ({"friction": 2.0}, "bounds"),
                          ({"traction": {"left": (890, -190)}}, "loads")):
        with pytest.raises(ProblemError, match=f"another problem: its {name} differ"):
            ContactSolution.Load(tmp_path, Example(**changes))
    text = (tmp_path / "solution.json").read_text()
    (tmp_path / "solution.json").write_text(text.replace('"format": 1', '"format": 99'))
    with pytest.raises(ProblemError, match="format 99"):
        ContactSolution.Load(tmp_path, Example())
    (tmp_path / "solution.json").write_text("{")
    with pytest.raises(ProblemError, match="holds no saved solution"):
        ContactSolution.Load(tmp_path, Example())


def test_report_says_what_a_person_asks(method):
    solution = UzawaSolver().Solve(Discretization(Example(), method, RectangleMesh(4), order=1))
    text = solution.Report()
    for words in ("converged", "linear solves", "separation", "stick", "slip", "penetration", "pressure", "int p_n",
                  "dirichlet right", "traction left", "foundation bottom", "Balance: whole body",
                  f"{solution.normalforce:.6g}"):
        assert words in text
    assert ("worst element" in text) == method.discontinuous
    assert ("integrated sigma n" in text) != method.discontinuous
    assert max(map(len, text.splitlines())) <= 100


def test_pickled_objects_are_never_read(tmp_path):
    """A file that holds one is refused, whoever wrote it."""
    UzawaSolver().Solve(Discretization(Example(), Conforming(), RectangleMesh(2), order=1)).Save(tmp_path)
    with np.load(tmp_path / "fields.npz") as fields:
        arrays = dict(fields)
    np.savez(tmp_path / "fields.npz", **{**arrays, "vector": np.array([{}, None], dtype=object)})
    with pytest.raises(ProblemError, match="holds no saved solution.*allow_pickle"):
        ContactSolution.Load(tmp_path, Example())
