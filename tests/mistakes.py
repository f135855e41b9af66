"""One mistake for every error that the library raises, with what its message must say: culprit | expectation | remedy.

A mistake is a function of an empty folder.  `test_errors` makes them all, and holds the lines that raised against the source.
"""

import json
from contextlib import contextmanager
from types import SimpleNamespace
from unittest.mock import patch

import numpy as np
import psutil
import scipy.sparse as sp
from conftest import Example
from netgen.geom2d import SplineGeometry
from netgen.occ import Circle
from ngsolve import CF, H1, BilinearForm, LinearForm, Mesh, VectorH1, VectorL2, dx, sqrt, x, y

from ngdgc import (LDG, AnisotropicMaterial, BassiEtAl, CheckLaws, CheckUniqueness, ComplianceLaw, Conforming, ContactProblem,
                   ContactSolution, CoulombFriction, Discretization, Foundation, FrictionLaw,
                   HookeMaterial, InteriorPenalty, Lifting, NestedNewtonSolver, NonsymmetricInteriorPenalty,
                   NormalCompliance, SemismoothNewtonSolver, Solve, TrescaFriction, UzawaSolver, accuracy, atlas, bench,
                   convergence, inverses, locking)
from ngdgc.consistency import ConsistencyResidual
from ngdgc.exact import AffinePatch, SmoothSlip, WinklerColumn
from ngdgc.export import Animation
from ngdgc.facets import Csr, Native
from ngdgc.graph import ContactGraph
from ngdgc.iterative import IterativeInverse
from ngdgc.lemmas import CriticalPenalty
from ngdgc.meshes import BoxMesh, RectangleMesh, ShapeMesh
from ngdgc.pattern import BlockMatrix
from ngdgc.plots import ComparisonFigure, DeformedFigure, SettingFigure
from ngdgc.stability import ExtremeEigenvalue
from ngdgc.sweep import Violation
from ngdgc.traces import FromTraces, Positive, RigidLimit, ThreeZones

SOFT = NormalCompliance(450)
SPRING = CF((0, -0.1))
PRESSED = {"dirichlet": {"top": SPRING}, "traction": None}
NAN = sqrt(-1 - x)


def Disc(method=None, *, n=2, mesh=None, order=1, **changes):
    """Example 4.1 on few elements, with some data replaced."""
    problem = Example(**{key: value for key, value in changes.items() if key not in ("assembly", "inverse")})
    options = {key: changes[key] for key in ("assembly", "inverse") if key in changes}
    return Discretization(problem, method or InteriorPenalty(), mesh or RectangleMesh(n), order=order, **options)


def On(**changes):
    """Foundation below with some data replaced."""
    return Foundation("bottom", **{"compliance": SOFT, **changes})


def Added(make, disc=None):
    """A form made of trial and test function, added to a Discretization."""
    disc = disc or Disc()
    return disc.Add(make(*disc.space.TnT()))


class Law(ComplianceLaw):
    """p_n = k r_+ with one method replaced by a mistake."""

    def Pressure(self, r):
        return np.maximum(r, 0)

    def PressureDerivative(self, r):
        return 1.0 * (r > 0)


class Attracting(Law):
    def Pressure(self, r):
        return np.maximum(r, 0) + 1


class Scattered(Law):
    def Pressure(self, r):
        return np.maximum(r, 0)[:, None] * np.ones(2) if np.any(r > 0) else 0 * r


class Pulling(Law):
    def Pressure(self, r):
        return -np.maximum(r, 0)


class Steep(Law):
    def PressureDerivative(self, r):
        return 2.0 * (r > 0)


class Friction(FrictionLaw):
    def Bound(self, r, p):
        return 1.0 * p


class Negative(Friction):
    def Bound(self, r, p):
        return -1.0 * p


class Misled(Friction):
    def BoundDerivatives(self, r, p):
        return np.ones_like(r), np.ones_like(r)


class Single(Friction):
    def Coefficient(self, slip):
        return 1.0


class Below(Friction):
    def Coefficient(self, slip):
        return -np.ones_like(slip), np.zeros_like(slip)


class Faded(Friction):
    def Coefficient(self, slip):
        return np.exp(-slip), np.exp(-slip)


class Empty(ComplianceLaw):
    """A law whose methods were forgotten."""


class Unbounded(FrictionLaw):
    """A friction law whose method was forgotten."""


def Inside():
    """A square with an interface inside."""
    geometry = SplineGeometry()
    geometry.AddRectangle((0, 0), (1, 1), bcs=["bottom", "right", "top", "left"], leftdomain=1)
    geometry.AddRectangle((0.3, 0.3), (0.7, 0.7), bc="interface", leftdomain=2, rightdomain=1)
    return Mesh(geometry.GenerateMesh(maxh=0.4))


def Refined():
    disc = Disc()
    disc.mesh.Refine()
    return disc.form


def Curved():
    disc = Disc()
    disc.mesh.Curve(2)
    return disc.form


def Assembled():
    disc = Disc()
    assert disc.matrix.height
    return Added(lambda u, v: BilinearForm(u * v * dx), disc)


def Elsewhere():
    space = VectorL2(RectangleMesh(2), order=1)
    u, v = space.TnT()
    return Disc().Add(BilinearForm(u * v * dx))


def Condensed():
    disc = Disc(Conforming(), order=2)
    u, v = disc.space.TnT()
    form = BilinearForm(disc.space, condense=True)
    form += u * v * dx
    return disc.Add(form)


def Nonsymmetric():
    return Disc(NonsymmetricInteriorPenalty(), inverse="sparsecholesky")


def Saved(folder):
    Solve(Disc()).Save(folder)
    return folder


def OtherFormat(folder):
    description = json.loads((Saved(folder) / "solution.json").read_text())
    (folder / "solution.json").write_text(json.dumps({**description, "format": 0}))
    return folder


def NoMesh(folder):
    (Saved(folder) / "mesh.vol.gz").unlink()
    return folder


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


def WithoutMkl():
    with patch.object(inverses, "HasPardiso", return_value=False):
        return Disc(inverse="pardisospd").inversekind


def TooLarge(**options):
    disc = Disc(**options)
    assert disc.matrix.height
    with Memory(1000):
        return disc.inverse


def Block():
    problem = ContactProblem(HookeMaterial(E=1, nu=0.3), Foundation("bottom", NormalCompliance(1)),
                             dirichlet={"top": CF((0, 0, 0))}, bodyforce=(0, 0, -1))
    return Discretization(problem, InteriorPenalty(), BoxMesh(2))


def Indefinite(disc):
    return IterativeInverse(disc, Native(Csr(disc.matrix) - 10 * sp.eye(disc.space.ndof))).Solve(disc.load)


def Unrelated():
    """Blocks for a mesh in which no element has a neighbour."""
    space = VectorL2(RectangleMesh(2), order=1, dgjumps=True)
    return BlockMatrix(space, np.arange(0, 3 * space.mesh.ne + 1, 3), sp.csr_matrix((space.mesh.ne,) * 2), 1)


def Overflowing():
    """Penetrations of 1e3 where the law has no more numbers."""
    contact = Disc(foundation=On(compliance=NormalCompliance(1e300, 5))).contact
    return contact.Pressure(np.full(len(contact.weights), 1e3))


def OverflowingGraph():
    contact = Disc(foundation=On(friction=TrescaFriction(1))).contact
    return ContactGraph(contact, np.full(len(contact.weights), 1.0)).At(np.full(contact.normals.shape, np.nan))


def Extreme():
    """Loads and a modulus whose quotient is no number."""
    return Disc(traction={"left": CF((1e300, 1e308))}, material=HookeMaterial(E=1e-200, nu=0.3))


FLOATING = {"dirichlet": None, "traction": None, "foundation": On()}
HELD = {"dirichlet": None, "traction": None, "foundation": On(friction=TrescaFriction(1)), "bodyforce": (0, -1)}

MISTAKES = [
    # Numbers, vectors and regions.
    (lambda _: NormalCompliance(float("inf")), "stiffness is inf | finite number or a CoefficientFunction | give"),
    (lambda _: NormalCompliance("soft"), "stiffness is 'soft' | a number or a scalar CoefficientFunction | give"),
    (lambda _: TrescaFriction(CF(1j)), "bound is complex | a real CoefficientFunction | give"),
    (lambda _: On(gap=CF((0, 0))), "gap has 2 components | a scalar | give"),
    (lambda _: Example(dirichlet={"right": 0}), "dirichlet['right'] is 0 | one component per dimension | give a vector"),
    (lambda _: Example(dirichlet={"right": (None, 0)}),
     "component 1 of dirichlet['right'] is None | a number or a scalar CoefficientFunction | give"),
    (lambda _: Example(bodyforce=CF((1j, 0))), "bodyforce is complex | a real CoefficientFunction | give"),
    (lambda _: Example(traction={"[": CF((0, 0))}),
     "traction region is '[' | a regular expression such as 'left|right' | give"),
    (lambda _: Disc(foundation=On(gap=H1(RectangleMesh(1)).TrialFunction())),
     "gap cannot be evaluated | that has values there | give a number or a CoefficientFunction"),
    (lambda _: Disc(bodyforce=VectorH1(RectangleMesh(1)).TrialFunction()),
     "bodyforce cannot be evaluated | that has values there | give a number or a CoefficientFunction"),
    (lambda _: Disc(foundation=On(gap=NAN)), "gap is not finite | division by zero or a root of a negative number | look for"),
    (lambda _: HookeMaterial(E=0, nu=0.3), "E is 0 | greater than 0 | must be"),
    (lambda _: CoulombFriction(-0.1), "coefficient is -0.1 | at least 0 | must be"),
    # Materials.
    (lambda _: HookeMaterial(E=1, nu=0.3, plane="both"), "plane='both' | 'strain' or 'stress' | choose"),
    (lambda _: HookeMaterial(E=1, nu=0.5), "nu is 0.5 | less than 0.5 | must be"),
    (lambda _: HookeMaterial(E=1), "HookeMaterial got ['E'] | E and nu, or mu and lam | give"),
    (lambda _: AnisotropicMaterial(5), "voigt is 5 | 3 x 3 (2D) or 6 x 6 (3D) matrix | give"),
    (lambda _: AnisotropicMaterial([[1, 0], [0, 1]]),
     "voigt has 2 rows of lengths [2, 2] | 3 x 3 (2D) or 6 x 6 (3D) | must be"),
    (lambda _: AnisotropicMaterial([[1, 2, 0], [0, 1, 0], [0, 0, 1]]),
     "voigt is not symmetric: entries differ by 2 | C_ijkl = C_klij | give a matrix"),
    (lambda _: AnisotropicMaterial([[1, 2, 0], [2, 1, 0], [0, 0, 1]]),
     "voigt is not positive definite: its smallest eigenvalue is -1 | all must be positive | look at signs"),
    (lambda _: Example(material=AnisotropicMaterial(np.eye(6))), "material: 3 | different dimensions | give all of them"),
    (lambda _: Discretization(ContactProblem(HookeMaterial(E=1, nu=0.3, plane="stress"), On(), roller={"top": 0}),
                              LDG(), BoxMesh(1)), "plane='stress' on a mesh of dimension 3 | in 2D only | take plane='strain'"),
    (lambda _: Disc(Conforming(), material=HookeMaterial(E=1000 + sqrt(0.97 - y), nu=0.3), order=5).matrix,
     "the material is not finite | some quadrature point | look for a division by zero"),
    (lambda _: Disc(material=HookeMaterial(E=1000 + sqrt((x - 0.5) ** 2 - 1e-10), nu=0.3)).matrix,
     "the material is not finite | some quadrature point | look for a division by zero"),
    # Laws.
    (lambda _: NormalCompliance(1, exponent=0), "exponent is 0 | a positive number | must be"),
    (lambda _: Foundation("bottom", 450), "compliance is 450 | Pressure(r) and PressureDerivative(r) | give a law such as"),
    (lambda _: On(friction=0.3), "friction is 0.3 | an object with Bound(r, p), or None | give a law such as"),
    (lambda _: Empty().Pressure(np.ones(1)), "Empty has no method Pressure(r) | array (npoints,) | write it"),
    (lambda _: Empty().PressureDerivative(np.ones(1)),
     "Empty has no method PressureDerivative(r) | array (npoints,) | write it"),
    (lambda _: Unbounded().Check(SOFT), "Unbounded has no method Bound(r, p) | array (npoints,) | write it"),
    (lambda _: On(compliance=Attracting()),
     "foundation of 'bottom': the pressure is not zero at penetration -1 | 0 for r <= 0 | must"),
    (lambda _: On(compliance=Scattered()), "the pressure has shape (1, 2) for 1 points | one value per point | give"),
    (lambda _: On(compliance=Pulling()), "the pressure at penetration 1e-06 is negative | >= 0 | it must be"),
    (lambda _: On(compliance=Steep()), "PressureDerivative | differs from the finite difference of Pressure | mend the one"),
    (lambda _: On(friction=Negative()), "the friction bound is negative | p_t >= 0, an array (npoints,) | it must be"),
    (lambda _: On(friction=Misled()), "BoundDerivatives | finite difference of Bound by the penetration | mend one of them"),
    (lambda _: On(friction=Single()), "Coefficient(slip) returns 1.0 | the pair of the factor and its derivative | give"),
    (lambda _: On(friction=Below()), "Coefficient is negative or not finite at slip 0 | >= 0 | it must be"),
    (lambda _: On(friction=Faded()), "the derivative that Coefficient returns | its finite difference at slip | mend the one"),
    (lambda _: CheckLaws(SOFT, depth=0), "depth is 0 | a positive length | give"),
    (lambda _: CheckLaws(NormalCompliance(1 + x)),
     "data that are CoefficientFunctions | only at points of a mesh | take the laws in"),
    (lambda _: Overflowing(), "a contact law returned a value that is not finite | for the penetrations that occur | look at"),
    (lambda _: OverflowingGraph(),
     "a contact law returned a value that is not finite | for the penetrations that occur | look at"),
    # Problems on a mesh.
    (lambda _: Example(material=2000), "material is 2000 | a HookeMaterial or an AnisotropicMaterial | give"),
    (lambda _: Example(foundation=[]), "foundation is [] | at least one | give a Foundation"),
    (lambda _: Example(dirichlet="right"), "dirichlet is 'right' | a dictionary {region: value} | give"),
    (lambda _: Example(bodyforce=(0, 0, 1)), "bodyforce: 3 | different dimensions | give all of them"),
    (lambda _: Disc(mesh=3), "mesh is 3 | an ngsolve.Mesh, for example Mesh( | give"),
    (lambda _: Disc(mesh=Mesh(SplineGeometry().GenerateMesh())),
     "0 volume elements | a mesh of an area in 2D or a volume | needs"),
    (lambda _: Disc(mesh=BoxMesh(1)), "the mesh has dimension 3 | the data of the problem have 2 | give both the same"),
    (lambda _: Disc(dirichlet={"rihgt": SPRING}),
     "dirichlet region 'rihgt' | matches no boundary | choose among bottom, left, right, top"),
    (lambda _: Disc(dirichlet={"right|bottom": SPRING}),
     "boundary 'bottom' is claimed twice | must not overlap | give it to one"),
    (lambda _: Disc(mesh=Inside(), foundation=Foundation("interface", SOFT)),
     "foundation region 'interface' | for the outer boundary only | rename the interface or the region"),
    (lambda _: Disc(roller={"top": 0}, traction={"top": CF((1, 1))}),
     "traction['top'] has a normal component on a roller | normal displacement is prescribed | give the tangential part"),
    (lambda _: Disc(**FLOATING),
     "the body floats: nothing resists translation along x | neither dirichlet nor roller | hold it with"),
    (lambda _: Disc(bodyforce=CF((sqrt(y - 0.03), 0)), order=5).loads, "bodyforce is not finite | quadrature point | look for"),
    (lambda _: Solve(Example()),
     "a ContactProblem has neither mesh nor method | a Discretization has both | give Solve(Discretization(problem"),
    # Discretisations.
    (lambda _: Discretization("4.1", LDG(), RectangleMesh(1)), "problem is '4.1' | a ContactProblem | give"),
    (lambda _: Disc(InteriorPenalty), "method is <class | an object such as InteriorPenalty() or Conforming() | give"),
    (lambda _: Disc(order=0), "order is 0 | an integer of at least 1 | must be"),
    (lambda _: Disc(assembly="fast"), "assembly is 'fast' | 'facet' or 'skeleton' | choose"),
    (lambda _: Curved(), "the mesh was refined or curved | after the Discretization was made | make a new one"),
    (lambda _: Refined(), "the mesh was refined | after the Discretization was made | make a new one"),
    (lambda _: Disc().Add(3), "form is 3 | BilinearForm or LinearForm on disc.space | give"),
    (lambda _: Elsewhere(), "form lives on another space | disc.space | make it on"),
    (lambda _: Assembled(), "the matrix or the load is there already | right after the Discretization is made | add forms"),
    (lambda _: Added(lambda u, v: LinearForm(CF((1 / (x - x), 0)) * v * dx)),
     "the added form | is not finite | look for a division"),
    (lambda _: Condensed(), "form is no sparse square matrix | without condense | make it BilinearForm(disc.space)"),
    (lambda _: Added(lambda u, v: BilinearForm((u * u) * (u * v) * dx)),
     "form is not linear | only bilinear forms | can be added"),
    (lambda _: Added(lambda u, v: BilinearForm(-1e6 * u * v * dx)).matrix,
     "with the forms that were added B_h | is not coercive (smallest eigenvalue -1.17e+03 | look at their sign and size"),
    (lambda _: UzawaSolver().Solve(Disc(**HELD)),
     "held by its foundation alone | iteration has no first step | take Solve(disc)"),
    (lambda _: UzawaSolver().Solve(Extreme()),
     "the elastic matrix cannot be factorised | response to the loads is not finite | look for coefficients of extreme size"),
    (lambda _: SemismoothNewtonSolver().Solve(Extreme()),
     "the elastic matrix cannot be factorised | response to the loads is not finite | look for coefficients of extreme size"),
    (lambda _: Solve(Disc(InteriorPenalty(penalty=2))),
     "penalty=2 loses coercivity | smallest eigenvalue -2.26 | penalty='auto'"),
    (lambda _: Solve(Disc(BassiEtAl(liftorder=1), order=3)),
     "penalty=auto loses coercivity | stress is not in the lifting space | take form='lifting'"),
    (lambda _: CriticalPenalty(Example(), BassiEtAl, RectangleMesh(2), order=3, liftorder=1),
     "BassiEtAl(penalty=1.0, liftorder=1) | is not coercive for any penalty | take the other form"),
    (lambda _: ExtremeEigenvalue(sp.diags(np.logspace(-12, 12, 60)), sp.identity(60), lambda b: b, "SA"),
     "no eigenvalue of the form | against its norm | look for coefficients of extreme size"),
    (lambda _: Unrelated(), "NGSolve's matrix has another pattern | the elements' neighbours | take assembly='skeleton'"),
    # Methods and liftings.
    (lambda _: LDG(penalty=0), "penalty is 0 | 'auto' or a positive number | give"),
    (lambda _: LDG(weighting="E"), "weighting is 'E' | 'mu' or 'C' | choose"),
    (lambda _: BassiEtAl(weighting="mu"), "weighting='mu' does not apply to Bassi | r_e is weighted by C | leave it out"),
    (lambda _: LDG(form="weak"), "form is 'weak' | 'edge' or 'lifting' | choose"),
    (lambda _: BassiEtAl(singular=1), "singular is 1 | True or False | give"),
    (lambda _: LDG(liftorder=-1), "liftorder is -1 | an integer of at least 0 | must be"),
    (lambda _: InteriorPenalty(liftorder=1),
     "liftorder=1 does not apply to the edge form of IP | it lifts nothing | leave it out"),
    (lambda _: BassiEtAl(liftorder=0), "liftorder=0 makes Bassi singular | r_e with constants | take liftorder >= 1"),
    (lambda _: Lifting(Disc(Conforming())), "method H1 has no jumps | to lift | take a discontinuous one"),
    (lambda _: Lifting(Disc(), order=-1), "order is -1 | the degree of the lifting space | must be an integer >= 0"),
    (lambda _: Lifting(Disc()).Matrix(99), "facet is 99 | the mesh has the facets 0 ... | give the number"),
    (lambda _: Lifting(Disc()).Global(3), "gfu is 3 | on the space of the discretisation | give a GridFunction"),
    (lambda _: Solve(Disc(Conforming())).flux, "method H1 has no numerical flux | a discontinuous one | take"),
    # Pictures.
    (lambda _: ComparisonFigure([]), "solutions is [] | a dictionary of ContactSolutions by their labels | give"),
    (lambda _: ComparisonFigure({"plane": Solve(Disc()), "solid": Solve(Block())}),
     "solution 'solid' has | the first one | compare solutions of one problem"),
    (lambda _: ComparisonFigure({"IP": Disc()}),
     "solution 'IP' is Discretization( | a ContactSolution | which Solve(disc) returns"),
    (lambda _: Animation([Solve(Disc()), Example()]), "solution 2 is ContactProblem( | a ContactSolution | give"),
    (lambda _: DeformedFigure(Disc()), "solution is Discretization( | a ContactSolution | which Solve(disc) returns"),
    (lambda _: SettingFigure(Solve(Disc())),
     "disc is ContactSolution( | a Discretization | that of a solution is solution.disc"),
    (lambda _: Animation([]), "given are 0 | of one dimension and order | give load steps of one Discretization"),
    # Inverses.
    (lambda _: Disc(inverse="lu").inversekind, "inverse is 'lu' | auto, sparsecholesky | choose"),
    (lambda _: Nonsymmetric().inversekind, "inverse='sparsecholesky' | is for symmetric matrices | take inverse='auto'"),
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
     "start has shapes [(), ()] | at the contact points | give displacement"),
    (lambda _: NestedNewtonSolver(coarser=[4]), "coarser is [4] | a sequence of ngsolve.Mesh, coarse ones first | give"),
    (lambda _: NestedNewtonSolver().Solve(None), "disc is None | Discretization(problem, method, mesh, order=1) | give"),
    (lambda _: NestedNewtonSolver(coarser=[BoxMesh(1)]).Solve(Disc()),
     "coarser: the mesh has dimension 3 | have 2 | give both"),
    (lambda _: Interrupted(3), "interrupted | after 3 iterations | the last iterate is its attribute solution"),
    (lambda _: Interrupted(0), " |  | "),
    # Verification.
    (lambda _: AffinePatch("glue"), "zone is 'glue' | 'slip', 'stick' or 'open' | choose"),
    (lambda _: AffinePatch("slip", dim=1), "dim is 1 | 2 or 3 | choose"),
    (lambda _: AffinePatch("slip", sides="free"), "sides is 'free' | 'dirichlet', 'traction' or 'roller' | choose"),
    (lambda _: WinklerColumn(load="force"), "load is 'force' | 'displacement' or 'pressure' | choose"),
    (lambda _: SmoothSlip(mu=1), "mu is 1 and lam is 1 | else the foundation would pull | take mu > 1 and lam > 0"),
    (lambda _: FromTraces(None, un=1, pressure=1), "foundation is None | of the region 'bottom' | give a Foundation"),
    (lambda _: FromTraces(On(), un=1, pressure=1, material=AnisotropicMaterial(np.eye(3))),
     "material is AnisotropicMaterial | whose mu and lam the recipe needs | give a HookeMaterial"),
    (lambda _: ThreeZones(ends=(0.5, 0.5)), "ends is (0.5, 0.5) | 0 < a < b < 1 | choose"),
    (lambda _: RigidLimit(stiffness=0), "stiffness is 0 | positive | must be"),
    (lambda _: FromTraces(On(), un=0.1 + Positive(x - 0.3, 2), pressure=45 + 450 * Positive(x - 0.3, 2)),
     "the second derivative of un jumps near x = 0.3 | sigma is discontinuous | give a smoother one"),
    (lambda _: FromTraces(On(), un=0.1, pressure=44),
     "the pressure is 44 and p_n(un - gap) is 45 | violate the law at x | mend"),
    (lambda _: FromTraces(On(friction=TrescaFriction(1)), un=0.1, pressure=45, shear=2),
     "the shear is 2, more than the friction bound 1 | violate the law at x | mend"),
    (lambda _: FromTraces(On(friction=TrescaFriction(1)), un=0.1, pressure=45, ut=0.1, shear=0.5),
     "ut is 0.1, not 0 | the shear must be the bound 1 | mend"),
    (lambda _: ConsistencyResidual(Disc(), 5), "displacement is 5 | which can be differentiated | give a CoefficientFunction"),
    (lambda _: ConsistencyResidual(Disc(), CF((1, 1))),
     "displacement differs from dirichlet['right'] by 1.41 | takes the prescribed | give"),
    (lambda _: ConsistencyResidual(Disc(**HELD), CF((0 * x, 0 * y))),
     "only contact resists | |||.||| is no norm | add dirichlet or roller"),
    (lambda _: CriticalPenalty(Example(), LDG(), RectangleMesh(1), form="edge"),
     "form given beside the object LDG( | a class | give"),
    (lambda _: CriticalPenalty(Example(), Conforming(), RectangleMesh(1)),
     "Conforming() has no penalty | discontinuous method | give a"),
    (lambda _: CheckUniqueness(Nonsymmetric()),
     "the method is not symmetric | a symmetric compliance operator | take a symmetric one"),
    (lambda _: CheckUniqueness(Disc(**HELD)),
     "held by its foundation alone | that its supports hold | add dirichlet or roller"),
    (lambda _: Violation(Solve(Disc(foundation=On(friction=Friction())))),
     "friction is | for the laws of the package alone | take one of them"),
    (lambda _: convergence.Study(SmoothSlip(), LDG(), n=(8, 4)),
     "n is (8, 4) | at least two sizes that increase | give for example"),
    (lambda _: locking.Study(LDG(), lam=(1,)), "lam is (1,) | at least two values | give for example"),
    (lambda _: accuracy.Study(SmoothSlip(), LDG(), budget=0), "budget is 0 | a positive number of seconds | give"),
    (lambda _: atlas.Point(problem="ball"), "problem is 'ball' | one of | choose"),
    (lambda _: atlas.Point(problem="block", stiffness=None), "stiffness is None | no foundation of its own | give k_n/E"),
    (lambda _: bench.Alone(print, 0), "repeat is 0 | at least one | give the number of runs"),
    (lambda _: ShapeMesh(None, 1), "shape is None | a face or a solid | give"),
    (lambda _: ShapeMesh(Circle((0, 0), 1).Face(), 0), "maxh is 0 | a positive number | give"),
    (lambda _: ShapeMesh(Circle((0, 0), 1).Face(), 1, order=0), "order is 0 | a positive integer | give"),
    (lambda _: RectangleMesh(0), "n is 0 | a positive integer | must be"),
    (lambda _: RectangleMesh(2, upper=80), "lower is (0, 0) and upper is 80 | two corners of 2 coordinates each | give"),
    (lambda _: RectangleMesh(2, upper=(80, -30)), "upper is (80, -30) | all of them larger in upper | give two corners"),
    (lambda _: BoxMesh(2, upper=(1, 1)), "upper is (1, 1) | two corners of 3 coordinates each | give"),
    (lambda _: RectangleMesh(2, cells="hexagon"), "cells is 'hexagon' | one of triangle | choose"),
    # Saved solutions.
    (lambda folder: ContactSolution.Load(folder, Example()),
     "holds no saved solution | ContactSolution.Save has written | give a folder"),
    (lambda folder: ContactSolution.Load(NoMesh(folder), Example()),
     "mesh.vol.gz is missing | ContactSolution.Save | give a folder"),
    (lambda folder: ContactSolution.Load(OtherFormat(folder), Example()), "has format 0 | this version reads 1 | save it anew"),
    (lambda folder: ContactSolution.Load(Saved(folder), Example(stiffness=400.0)),
     "was computed with another problem | its pressures differ | give the one it was saved with")]
