"""What Save has written Load reads, exactly, and for the same discrete problem alone."""

import os
import subprocess
import sys
from fractions import Fraction
from importlib.metadata import version

import numpy as np
import pytest
from bodies import Plate, Ring
from mistakes.saved import Edited
from netgen.csg import CSGeometry, Pnt
from netgen.csg import Sphere as Ball
from netgen.geom2d import SplineGeometry
from netgen.occ import Circle, OCCGeometry, Sphere
from ngsolve import CF, BilinearForm, LinearForm, Mesh, Parameter, ds, dx
from problems import TEN, Adjustable, Resting

from ngdgc import (LDG, BassiEtAl, Conforming, ContactProblem, ContactSolution, CoulombFriction, Discretization, Foundation,
                   HookeMaterial, InteriorPenalty, NonsymmetricInteriorPenalty, NormalCompliance, ProblemError, Solve,
                   TrescaFriction)
from ngdgc.solution import storage
from ngdgc.meshes import BoxMesh, RectangleMesh

# Of programs that use what stands in the tests.
FINDING = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}

SLIGHT = 1e-4       # relative difference of two problems: 100 times the tolerance of the comparison
ROUNDOFF = 1e-12    # the same for one problem that is written in two ways


DATA = {"E": 1000.0, "nu": 0.3, "k": 300.0, "exponent": 1.0, "mu": 0.4, "gap": 0.01, "top": -0.03, "side": 0.002, "pull": 2.0,
        "weight": -3.0}


@pytest.fixture(scope="module", params=[InteriorPenalty(), Conforming()], ids=repr)
def kept(request, tmp_path_factory):
    """A folder with a solution of `Adjustable()`."""
    folder = tmp_path_factory.mktemp("kept")
    Solve(Discretization(Adjustable(), request.param, RectangleMesh(3), order=2)).Save(folder)
    return folder


@pytest.mark.slow
@pytest.mark.parametrize("name", DATA)
def test_a_slight_difference_makes_another_problem(kept, name):
    with pytest.raises(ProblemError, match="another problem"):
        ContactSolution.Load(kept, Adjustable(**{name: DATA[name] * (1 + SLIGHT)}))
    # Control: a difference of round-off makes none.
    assert ContactSolution.Load(kept, Adjustable(**{name: DATA[name] * (1 + ROUNDOFF)})).converged


def test_the_same_problem_may_be_written_in_another_way(tmp_path):
    """Regions apart or as one expression, a tuple or a CoefficientFunction; but not one support for another."""
    def Held(dirichlet=None, roller=None):
        return ContactProblem(HookeMaterial(E=1000, nu=0.3), Foundation("bottom", NormalCompliance(300)), dirichlet=dirichlet,
                              roller=roller, traction={"top": (0, -5)})
    for method in (InteriorPenalty(), Conforming()):
        Solve(Discretization(Held(dirichlet={"left|right": (0, 0)}), method, RectangleMesh(2))).Save(tmp_path)
        assert ContactSolution.Load(tmp_path, Held(dirichlet={"left": CF((0, 0)), "right": (0, 0)})).converged
        for other in (Held(dirichlet={"left": (0, 0)}), Held(dirichlet={"left": (0, 0)}, roller={"right": 0}),
                      Held(roller={"left|right": 0})):
            with pytest.raises(ProblemError, match="another problem: its regions differ"):
                ContactSolution.Load(tmp_path, other)


@pytest.mark.slow
def test_parameters_are_kept_as_they_were_solved_with(tmp_path):
    """A Parameter that was set anew since is none of the solution's: its values of then are compared, in every datum."""
    for name in ("E", "k", "mu", "gap", "top", "side", "pull", "weight"):
        value = Parameter(DATA[name])
        solution = Solve(Discretization(Adjustable(**{name: value}), InteriorPenalty(), RectangleMesh(2)))
        value.Set(1.5 * DATA[name])
        solution.Save(tmp_path)
        assert ContactSolution.Load(tmp_path, Adjustable()).normalforce == pytest.approx(solution.normalforce, rel=1e-12)
        with pytest.raises(ProblemError, match="another problem"):
            ContactSolution.Load(tmp_path, Adjustable(**{name: value}))


def test_laws_that_agree_at_the_solution_alone_are_others(tmp_path):
    """k r and k r_s (r/r_s)^2 have the same pressure at the only penetration r_s that occurs; so have two friction laws."""
    def Pressed(law, friction):
        return ContactProblem(HookeMaterial(E=1000, nu=0), Foundation("bottom", law, friction=friction),
                              roller={"left|right": 0}, traction={"top": (0, -6)})
    linear, tresca = NormalCompliance(300), TrescaFriction(2)
    solution = Solve(Discretization(Pressed(linear, tresca), LDG(), RectangleMesh(2)))
    solution.Save(tmp_path)
    deep = 6 / 300
    assert solution.penetration == pytest.approx(deep)
    for law, friction in ((NormalCompliance(300 / deep, 2), tresca), (linear, CoulombFriction(1 / 3))):
        with pytest.raises(ProblemError, match="another problem: its laws differ"):
            ContactSolution.Load(tmp_path, Pressed(law, friction))
    assert ContactSolution.Load(tmp_path, Pressed(linear, tresca)).converged


@pytest.mark.slow
@pytest.mark.parametrize("method", [InteriorPenalty(), LDG(form="lifting"), Conforming()], ids=repr)
def test_added_forms_are_given_again(method, tmp_path):
    """As functions of the space, or as forms on the space of the script that saved."""
    def Springs(space, k=500.0):
        u, v = space.TnT()
        return BilinearForm(k * u * v * ds(skeleton=True, definedon="right"))

    def Pull(space, p=1.0):
        return LinearForm(CF((p, 0)) * space.TestFunction() * dx)
    disc = Discretization(Adjustable(), method, RectangleMesh(3), order=2)
    solution = Solve(disc.Add(Springs(disc.space)).Add(Pull(disc.space)))
    solution.Save(tmp_path)
    for added in ([Springs, Pull], [Pull, Springs], [Springs(disc.space), Pull(disc.space)]):
        loaded = ContactSolution.Load(tmp_path, Adjustable(), added=added)
        assert loaded.normalforce == pytest.approx(solution.normalforce, rel=1e-12)
        assert loaded.GlobalImbalance() < 1e-9
    for added in ([], [Springs], [Pull], [lambda space: Springs(space, 500 * (1 + SLIGHT)), Pull],
                  [Springs, lambda space: Pull(space, 1 + SLIGHT)]):
        with pytest.raises(ProblemError, match="added forms|loads"):
            ContactSolution.Load(tmp_path, Adjustable(), added=added)
    Solve(Discretization(Adjustable(), method, RectangleMesh(3), order=2)).Save(tmp_path)
    with pytest.raises(ProblemError, match="without added forms; leave them out"):
        ContactSolution.Load(tmp_path, Adjustable(), added=[Springs])


@pytest.mark.slow
@pytest.mark.parametrize("method", [*TEN, NonsymmetricInteriorPenalty(), InteriorPenalty(penalty=Fraction(61, 2)),
                                    BassiEtAl(liftorder=2), Conforming()], ids=repr)
def test_method_assembly_and_inverse_are_kept(method, tmp_path):
    inverse = "auto" if isinstance(method, NonsymmetricInteriorPenalty) else "sparsecholesky"
    disc = Discretization(Adjustable(), method, RectangleMesh(2), order=2, assembly="skeleton", inverse=inverse)
    solution = Solve(disc)
    solution.Save(tmp_path)
    loaded = ContactSolution.Load(tmp_path, Adjustable())
    assert (loaded.disc.method, loaded.disc.order, loaded.disc.assembly, loaded.disc.wanted) == (method, 2, "skeleton", inverse)
    # The first line has the arguments, a fraction as the number that it is.
    assert loaded.Report().splitlines()[1:] == solution.Report().splitlines()[1:] and loaded.levels == solution.levels


def Disc(curve=1, *, second=False, refined=0, spline=False):
    """A round disc whose edge is "ring"."""
    if spline:
        geometry = SplineGeometry()
        geometry.AddCircle((0, 0), 1, bc="ring")
    else:
        shape = Circle((0, 0), 1).Face()
        shape.edges.name = "ring"
        geometry = OCCGeometry(shape, dim=2)
    netgen = geometry.GenerateMesh(maxh=0.7)
    if second:
        netgen.SecondOrder()
    mesh = Mesh(netgen)
    for _ in range(refined):
        for element in mesh.Elements():
            mesh.SetRefinementFlag(element, element.nr % 3 == 0)
        mesh.Refine()
    return mesh.Curve(curve) if curve > 1 else mesh


def Sphere3(curve=1, second=False):
    shape = Sphere((0, 0, 0), 1)
    shape.faces.name = "ring"
    netgen = OCCGeometry(shape).GenerateMesh(maxh=1)
    if second:
        netgen.SecondOrder()
    return Mesh(netgen).Curve(curve) if curve > 1 else Mesh(netgen)


def Solid():
    """The same by another of Netgen's geometries, whose file names materials otherwise."""
    geometry = CSGeometry()
    geometry.Add(Ball(Pnt(0, 0, 0), 1).bc("rim"))
    return Mesh(geometry.GenerateMesh(maxh=0.9)).Curve(2)


def Named(mesh, name):
    mesh.ngmesh.SetBCName(0, name)
    return mesh


def Tiny():
    return Named(RectangleMesh(2, upper=(1e-9, 1e-9)), "ring")


MESHES = {"curved": lambda: Disc(3), "spline": lambda: Disc(4, spline=True), "second": lambda: Disc(second=True),
          "second spline": lambda: Disc(second=True, spline=True), "refined": lambda: Disc(refined=2),
          "refined and curved": lambda: Disc(3, refined=1), "hole": lambda: Plate(), "quarter": lambda: Ring(2, 0.7),
          "tiny": Tiny, "solid": lambda: Sphere3(2), "solid second": lambda: Sphere3(second=True), "csg": Solid,
          "hex": lambda: BoxMesh(2, cells="hex"), "prism": lambda: BoxMesh(2, cells="prism"),
          "quad": lambda: RectangleMesh(3, cells="quad"), "names": lambda: Named(RectangleMesh(2), "a (ring)\nof, two | lines")}
# A process of its own: NGSolve gives a mesh that it reads the geometry that was made last, which is none here.
ANEW = """
import sys
from ngdgc import ContactSolution
from problems import Resting
for folder in sys.argv[1:]:
    loaded = ContactSolution.Load(folder, Resting(folder.split("/")[-2]))
    print(repr(loaded.normalforce), repr(float(loaded.points.sum())))
"""


@pytest.mark.slow
def test_meshes_come_back_exactly(tmp_path):
    """Curved, refined, of second order, without geometry in the file, tiny: the same points and forces in another process."""
    folders, expected = [], []
    for name, Make in MESHES.items():
        mesh = Make()
        for method in (InteriorPenalty(), Conforming()) if mesh.ne < 100 or mesh.dim == 2 else (Conforming(),):
            solution = Solve(Discretization(Resting(name), method, mesh, order=2 if mesh.dim == 2 else 1))
            folders.append(tmp_path / name / method.name)
            solution.Save(folders[-1])
            expected += [solution.normalforce, solution.points.sum()]
    result = subprocess.run([sys.executable, "-c", ANEW, *map(str, folders)], capture_output=True, text=True, check=False,
                            cwd=tmp_path, env=FINDING)
    assert result.returncode == 0, result.stderr
    # Round-off: a refined and curved mesh is curved a second time, all others are the same to the last bit.
    assert np.array(result.stdout.split(), dtype=float) == pytest.approx(np.array(expected), rel=1e-12)
    assert min(abs(force) for force in expected[::2]) > 1e-12


def test_control_text_files_do_not_keep_such_meshes(tmp_path):
    """What they lose is far more than the tolerance of the exact ones: curves have eight decimals, second order no middles."""
    mesh, lost = Disc(3, spline=True), []
    for kind in ("bin", "gz"):
        mesh.ngmesh.Save(str(tmp_path / f"mesh.vol.{kind}"))
        lost.append(np.abs(storage._Points(Mesh(str(tmp_path / f"mesh.vol.{kind}"))) - storage._Points(mesh)).max())
    assert lost[0] == 0 and 1e-10 < lost[1] < 1e-7
    mesh = Disc(second=True)
    mesh.ngmesh.Save(str(tmp_path / "mesh.vol.gz"))
    assert not storage._Same(mesh, Mesh(str(tmp_path / "mesh.vol.gz")))


def test_another_version_of_ngsolve_reads_the_text_file(tmp_path):
    solution = Solve(Discretization(Resting("spline"), Conforming(), Disc(3, spline=True), order=2))
    solution.Save(tmp_path)
    loaded = ContactSolution.Load(Edited(tmp_path, words={"ngsolve": "6.1"}), Resting("spline"))
    # Eight decimals.
    assert loaded.points == pytest.approx(solution.points, abs=1e-7) and loaded.normalforce == pytest.approx(
        solution.normalforce, rel=1e-6)
    Edited(tmp_path, words={"ngsolve": version("ngsolve")})
    (tmp_path / "mesh.vol.gz").write_bytes(b"")
    with pytest.raises(ProblemError, match="is damaged: mesh.vol.gz"):
        ContactSolution.Load(tmp_path, Resting("spline"))
