"""What users ask of a body of revolution: moments, lines, files, reports, and materials of more than two constants."""

import numpy as np
import pytest
from bodies import Mixed
from ngsolve import CF, x
from ngsolve.meshes import MakeStructured2DMesh
from rings import Smooth

from ngdgc import (LDG, AnisotropicMaterial, BassiEtAl, Conforming, ContactProblem, Discretization, Foundation, HookeMaterial,
                   InteriorPenalty, NormalCompliance, SemismoothNewtonSolver, Solve)
from ngdgc.errors import EnergyError, L2Error
from ngdgc.mesh.facets import Csr
from ngdgc.meshes import RectangleMesh
from ngdgc.solution.turned import SHARE, ColourLimits
from ngdgc.solution.vtkfiles import ElementGrid

A, K = 0.01, 200.0
# Around the axis four times as stiff as along r, in the order r, z, theta: u_r = -A r^2 without body force.
WOUND = AnisotropicMaterial([[100, 30, 40, 0, 0, 0], [30, 150, 50, 0, 0, 0], [40, 50, 400, 0, 0, 0],
                             [0, 0, 0, 40, 0, 0], [0, 0, 0, 0, 35, 0], [0, 0, 0, 0, 0, 45]])
SHARP = SemismoothNewtonSolver(tol=1e-13)


@pytest.fixture(scope="module")
def smooth():
    problem, u = Smooth()
    return Solve(Discretization(problem, InteriorPenalty(), RectangleMesh(6), order=2)), u


def Wound(material=WOUND):
    """A ring wound of fibres around its axis, 1 < r < 2, pressed into a bore between rollers: nothing moves along z."""
    exact, stress = CF((-A * x * x, 0)), -(4 * A * 100 + 2 * A * 40)        # sigma_rr at r = 2
    foundation = Foundation("right", NormalCompliance(K), gap=-4 * A + stress / K)
    return ContactProblem(material, foundation, dirichlet={"left": exact}, roller={"bottom": 0, "top": 0},
                          axisymmetric=True), exact, -stress


@pytest.mark.parametrize("method", [InteriorPenalty(), BassiEtAl(form="lifting"), LDG(), Conforming()],
                         ids=["IP", "Bassi", "LDG", "H1"])
def test_wound_ring_is_exact(method):
    """Lekhnitskii's power r^sqrt(C_tt/C_rr) is a polynomial here, and every method returns it; with another C_tt none does."""
    mesh = MakeStructured2DMesh(quads=False, nx=2, ny=1, mapping=lambda s, t: (1 + s, t))
    problem, exact, pressure = Wound()
    off = []
    for material in (WOUND, AnisotropicMaterial([[*row[:2], 390 if n == 2 else row[2], *row[3:]]
                                                 for n, row in enumerate(WOUND.voigt)])):
        solution = SHARP.Solve(Discretization(Wound(material)[0], method, mesh, order=2))
        off.append(max(L2Error(solution, exact) / A, np.abs(solution.pressure / pressure - 1).max()))
    assert off[0] < 1e-10 < 1e-4 < off[1]


def test_both_assemblies_know_the_material():
    problem, _, _ = Wound()
    mesh = MakeStructured2DMesh(quads=True, nx=2, ny=1, mapping=lambda s, t: (1 + s, t * (1 + s / 4)))
    for method in (InteriorPenalty(), LDG(form="lifting")):
        facet, skeleton = (Csr(Discretization(problem, method, mesh, order=2, assembly=assembly).matrix)
                           for assembly in ("facet", "skeleton"))
        assert abs(facet - skeleton).max() < 1e-13 * abs(skeleton).max()


@pytest.mark.parametrize("method", [LDG(), Conforming()], ids=["LDG", "H1"])
def test_moment_turns_the_section(method):
    """Of constant stress: each region's about the circle (r0, z0) in closed form, and in sum that of the hoop stress."""
    steel, r0, z0 = HookeMaterial(E=100, nu=0.3), 0.4, 0.2
    hoop, axial = (steel.lam * (2 * A - 0.05) + 2 * steel.mu * slope for slope in (A, -0.05))
    problem = ContactProblem(steel, Foundation("bottom", NormalCompliance(50), gap=axial / 50), axisymmetric=True,
                             traction={"right": (hoop, 0), "top": (0, axial)})
    solution = SHARP.Solve(Discretization(problem, method, Mixed(), order=2))
    assert np.abs(np.asarray(solution.stress(solution.disc.mesh(0.3, 0.3)))[0] - hoop) < 1e-10
    moments = [solution.Moment(region, point=(r0, z0))[0] for region in ("right", "top", "bottom")]
    edge = 2 * np.pi * axial * (1 / 3 - r0 / 2)
    np.testing.assert_allclose(moments, [-2 * np.pi * hoop * (1 / 2 - z0), edge, -edge], rtol=1e-10)


def test_a_line_along_the_axis(smooth):
    """There u_r/r is d_r u_r, also of a line that is moved off the sides of elements by less than anything."""
    solution, u = smooth
    line = solution.Along((0, 0.1), (0, 0.9), 9)
    z = line["point"][:, 1]
    np.testing.assert_allclose(line["stress"][:, 2, 2], line["stress"][:, 0, 0], rtol=1e-6)
    plane = solution.disc.problem.material
    strain = 0.1 * (1 + z ** 2 / 2), -0.3 - 0.05 - 0.02 * np.exp(z)
    np.testing.assert_allclose(line["stress"][:, 2, 2], plane.lam * (2 * strain[0] + strain[1]) + 2 * plane.mu * strain[0],
                               atol=3e-3)


def test_cells_of_files_are_rings(smooth):
    """Sizes are volumes around, and means times sizes are integrals over the body."""
    solution, _ = smooth
    grid = ElementGrid(solution.disc.facets, 2)
    assert grid.Sizes().sum() == pytest.approx(np.pi, rel=1e-12)
    ones = np.ones((len(grid.points), 1))
    integrals = np.pi / solution.disc.mesh.ne * np.ones((solution.disc.mesh.ne, 1))
    assert (grid.Sizes() @ grid.Means(ones, integrals)).item() == pytest.approx(np.pi, rel=1e-12)


def test_radial_tractions_have_no_sum(smooth):
    report = smooth[0].Report()
    row = next(line for line in report.splitlines() if line.startswith("  sum"))
    assert row.split()[1] == "-" and abs(float(row.split()[2])) < 1e-6


def test_stiffness_of_contact_counts_facets_in_the_plane():
    """Newton's stiffness goes with the size of the facets, not of the rings that they stand for."""
    disc = Discretization(Smooth()[0], LDG(), Mixed(), order=1)
    lengths = np.where(disc.contact.coordinates[:, 0] < 0.6, 0.6, 0.4)
    np.testing.assert_allclose(disc.contact.measures, lengths, rtol=1e-12)


def test_colours_are_not_taken_by_a_peak():
    """Where a few values are far off, the others have the colours, and the bar says so."""
    areas = np.ones(1000)
    assert ColourLimits(np.linspace(0, 1, 1000), areas) == {}
    cut = ColourLimits(np.append(np.linspace(0, 1, 998), [50, 90]), areas)
    assert cut["funcmax"] == pytest.approx(SHARE, abs=2e-3) and "0 to 90 in all" in cut["cut"]


def test_error_of_a_material_that_varies(smooth):
    """Hooke's law as a matrix of functions gives the same solution."""
    solution, u = smooth
    lam, mu = (CF(value) for value in (solution.disc.problem.material.lam, solution.disc.problem.material.mu))
    voigt = [[lam + 2 * mu if i == j < 3 else lam if max(i, j) < 3 else mu if i == j else 0 for j in range(6)]
             for i in range(6)]
    data = solution.disc.problem
    other = ContactProblem(AnisotropicMaterial(voigt), data.foundation, dirichlet=dict(data.dirichlet),
                           bodyforce=data.bodyforce, axisymmetric=True)
    again = Solve(Discretization(other, InteriorPenalty(), RectangleMesh(6), order=2))
    assert EnergyError(again, u) == pytest.approx(EnergyError(solution, u), rel=0.05)
