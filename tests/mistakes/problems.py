"""Mistakes in problems on a mesh, in their discretisations, methods and liftings, as in `mistakes`."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import scipy.sparse as sp
from bodies import LINE, Crossed, Layers
from mistakes import HELD, SOFT, Disc, Inside, Jointed, On
from netgen.geom2d import SplineGeometry
from ngsolve import CF, H1, BilinearForm, GridFunction, LinearForm, Mesh, Parameter, Variation, VectorL2, ds, dx, sqrt, x, y
from problems import Example

from ngdgc import (LDG, BassiEtAl, ComplianceLaw, Conforming, ContactProblem, Discretization, EstimateError, EstimateForce,
                   EstimateZones, Foundation, HookeMaterial, InteriorPenalty, Joint, Lifting, RigidPunch,
                   SemismoothNewtonSolver, Solve, UzawaSolver, WeaklyOverPenalised)
from ngdgc.estimates.residual import ResidualEstimate
from ngdgc.theory.lemmas import CriticalPenalty
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.blocks.matrix import BlockMatrix
from ngdgc.methods.coercivity import ExtremeEigenvalue

SPRING = CF((0, -0.1))


def Added(make, disc=None):
    """A form made of trial and test function, added to a Discretization."""
    disc = disc or Disc()
    return disc.Add(make(*disc.space.TnT()))


def Lifted(liftorder):
    problem = ContactProblem(HookeMaterial(E=1, nu=0.3), On(), dirichlet={"top": (0, 0, -1)})
    return Discretization(problem, LDG(liftorder=liftorder), BoxMesh(1))


def Renamed(name):
    """A square whose right side has this name."""
    mesh = RectangleMesh(2)
    mesh.ngmesh.SetBCName(mesh.GetBoundaries().index("right"), name)
    return mesh


@dataclass(frozen=True)
class Ending(ComplianceLaw):
    """p_n = 1 - exp(-r), never more than 1."""

    def Pressure(self, r):
        return -np.expm1(-np.maximum(r, 0))

    def PressureDerivative(self, r):
        return np.where(r > 0, np.exp(-np.maximum(r, 0)), 0)


def SecondOrder():
    mesh = Inside().ngmesh
    mesh.SecondOrder()
    return Mesh(mesh)


def Refined():
    disc = Disc()
    disc.mesh.Refine()
    return disc.form


def Curved():
    disc = Disc()
    disc.mesh.Curve(2)
    return disc.form


def Parametric(change, Use):
    """What is asked of a solution with a Parameter as modulus and a GridFunction as gap, after one of them was changed."""
    modulus, mesh = Parameter(2000), RectangleMesh(2)
    gap = GridFunction(H1(mesh))
    solution = Solve(Disc(mesh=mesh, material=HookeMaterial(E=modulus, nu=0.3), foundation=On(gap=gap)))
    change(modulus, gap)
    return Use(solution)


def Assembled():
    disc = Disc()
    assert disc.matrix.height
    return Added(lambda u, v: BilinearForm(u * v * dx), disc)


def Elsewhere():
    space = VectorL2(RectangleMesh(2), order=1)
    u, v = space.TnT()
    return Disc().Add(BilinearForm(u * v * dx))


def Quadratic():
    """An energy, which is no bilinear form though its derivative is one."""
    disc = Disc()
    form = BilinearForm(disc.space)
    form += Variation(disc.space.TrialFunction() ** 2 * dx)
    return disc.Add(form)


def Condensed():
    disc = Disc(Conforming(), order=2)
    u, v = disc.space.TnT()
    form = BilinearForm(disc.space, condense=True)
    form += u * v * dx
    return disc.Add(form)


def Unrelated():
    """Blocks for a mesh in which no element has a neighbour."""
    space = VectorL2(RectangleMesh(2), order=1, dgjumps=True)
    return BlockMatrix(space, np.arange(0, 3 * space.mesh.ne + 1, 3), sp.csr_matrix((space.mesh.ne,) * 2), 1)


def Extreme():
    """Loads and a modulus whose quotient is no number."""
    return Disc(traction={"left": CF((1e300, 1e308))}, material=HookeMaterial(E=1e-200, nu=0.3))


def Punched(foundation=None, **punch):
    """Example 4.1 on a rigid punch."""
    return Disc(foundation=On(punch=RigidPunch(**punch), **(foundation or {})))


PUNCHES = [
    (lambda _: On(punch=5), "punch is 5 | a RigidPunch | such as RigidPunch(force="),
    (lambda _: RigidPunch(), "a punch has no force, moment, displacement or rotation | give one | leave punch= out"),
    (lambda _: RigidPunch(force=5), "force of a punch is 5 | 2 or 3 entries, with None | give"),
    (lambda _: RigidPunch(force=(None, "5")), "component 2 of force of a punch is '5' | a number | give"),
    (lambda _: RigidPunch(moment=(1, 2)), "moment of a punch is (1, 2) | a number in 2D and 3 entries in 3D | give"),
    (lambda _: RigidPunch(rotation=0, about=(0, CF(1))), "about of a punch is (0.0, | 2 or 3 numbers | such as (0, 1)"),
    (lambda _: RigidPunch(force=(None, -5), moment=(0, 0, 0)), "force: 2, moment: 3 | different dimensions | give all of them"),
    (lambda _: RigidPunch(force=(None, -5), displacement=(0, 0.1)),
     "component 2 of a punch has a force and a displacement | one of them | give"),
    (lambda _: Punched(force=(0, 0, 1)), "punch of foundation 'bottom': 3 | different dimensions | give all of them"),
    (lambda _: Punched(force=(None, x)), "load of punch varies from 0 | a rigid body has one | give a number"),
    (lambda _: Punched(force=(0, 5), foundation={"friction": None}).matrix,
     "nothing resists the translation of the punch 'bottom' along x | hold it, with None | give the foundation friction"),
    (lambda _: Solve(Discretization(Example(foundation=On(punch=RigidPunch(force=(None, 5)))), LDG(), RectangleMesh(2),
                                    inverse="iterative")), "inverse='iterative' | not for punches | take inverse='auto'"),
    (lambda _: Solve(Punched(force=(None, -5))), "there is no equilibrium | pull the body off | other loads"),
    *((lambda _, estimate=estimate: estimate(Solve(Punched(displacement=(0, 0.1)))),
       "the foundation 'bottom' is a rigid punch | no estimate here knows | give its displacement as a gap")
      for estimate in (EstimateError, EstimateForce, EstimateZones, ResidualEstimate))]
FLOATING = {"dirichlet": None, "traction": None, "foundation": On()}
PROBLEMS = [
    # Problems on a mesh.
    (lambda _: Example(material=2000), "material is 2000 | a HookeMaterial or an AnisotropicMaterial | give"),
    (lambda _: Example(units="mm"), "units is 'mm' | those of length and stress of all data | give"),
    (lambda _: Example(units=("mm", "mPa")), "no unit 'mPa' of stress | choose one of Pa, kPa, MPa | did you mean"),
    (lambda _: Example(foundation=[]), "foundation is [] | at least one | give a Foundation"),
    (lambda _: Example(dirichlet="right"), "dirichlet is 'right' | a dictionary {region: value} | give"),
    (lambda _: Disc(force={"left": CF((0, y))}, traction=None),
     "force['left'] varies over its region | it is the total | give traction for what varies"),
    (lambda _: Disc(spring={"top": -3}), "spring['top'] is -3 | at least 0 | it must be"),
    (lambda _: Example(spring={"top": (1, 2, 3)}), "spring['top']: 3 | different dimensions | give all of them"),
    (lambda _: Disc(spring={"top": "soft"}), "spring['top'] is 'soft' | a vector | give"),
    (lambda _: Disc(spring={"right": 3}), "boundary 'right' is claimed twice | must not overlap | give it to one"),
    (lambda _: Disc(foundation=On(normal=(0, 1))),
     "normal does not point out of the body at 4 of 4 points | N points from the body | take its negative"),
    (lambda _: Disc(foundation=On(normal=(0, x - x))),
     "foundation 'bottom': normal vanishes at 4 of 4 points | from the body into the foundation | give a vector"),
    (lambda _: Example(foundation=On(normal=(0, 0, -1))),
     "normal of foundation 'bottom': 3 | different dimensions | give all of them"),
    *PUNCHES,
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
     "foundation region 'interface' | for the outer boundary only | give a Joint there, or rename the interface"),
    (lambda _: Jointed(region="bottom"),
     "joint region 'bottom' contains facets of the outer boundary | between two elements | give a Foundation there"),
    (lambda _: Jointed(region="fault"), "joint region 'fault' matches no boundary | choose among | interface"),
    (lambda _: Disc(mesh=Inside(), foundation=[Joint("interface", SOFT), Foundation("interface", SOFT)]),
     "boundary 'interface' is claimed twice, by joint 'interface' and by foundation | must not overlap | give it to one"),
    (lambda _: Disc(mesh=Layers(2), foundation=[Joint("mid", SOFT)], dirichlet={"bottom": SPRING}, traction=None).matrix,
     "nothing resists translation along x in part 2 | neither dirichlet nor roller | hold it with"),
    (lambda _: Joint("interface", SOFT, normal=(0, 1)),
     "Joint(...): there is no argument 'normal' | choose among boundary, compliance, friction, gap, wear, tension | choose"),
    (lambda _: Jointed(tension=-1), "joint 'interface': tension is -1 | at least 0 | must be"),
    (lambda _: Disc(mesh=Inside(), foundation=[Joint("interface", Ending(), tension=5)]),
     "joint 'interface': tension is 5 | reaches at no penetration | make the tension less"),
    (lambda _: Jointed(gap=sqrt(x - 0.5)), "joint 'interface': gap is not finite | point | look for"),
    (lambda _: Disc(Conforming(), mesh=SecondOrder(), foundation=[Joint("interface", SOFT)]),
     "the mesh has elements of second order | needs its nodes doubled on joint 'interface' | take a discontinuous method"),
    (lambda _: Disc(Conforming(), mesh=Crossed({"short": [LINE[2:4]]}), foundation=[Joint("short", SOFT)]),
     "joint 'short' has no vertex between its ends | at which continuous displacements could jump | take smaller elements"),
    (lambda _: Disc(mesh=Inside(), foundation=[Joint("interface", SOFT)], assembly="skeleton"),
     "assembly is 'skeleton' | couples elements across joint 'interface' | take 'facet'"),
    (lambda _: Disc(roller={"top": 0}, traction={"top": CF((1, 1))}),
     "traction['top'] has a normal component on a roller | normal displacement is prescribed | give the tangential part"),
    (lambda _: Disc(**FLOATING).matrix,
     "the body floats: nothing resists translation along x | neither dirichlet nor roller | hold it with"),
    (lambda _: Disc(bodyforce=CF((sqrt(y - 0.03), 0)), order=5).loads, "bodyforce is not finite | quadrature point | look for"),
    (lambda _: Solve(Example()),
     "a ContactProblem has neither mesh nor method | a Discretization has both | give Solve(Discretization(problem"),
    # Discretisations.
    (lambda _: Discretization("4.1", LDG(), RectangleMesh(1)), "problem is '4.1' | a ContactProblem | give"),
    (lambda _: Disc(InteriorPenalty), "method is <class | an object such as InteriorPenalty() or Conforming() | give"),
    (lambda _: Disc(SimpleNamespace(name="own", Form=None)),
     "which has no ScalarSpace, Space | such as InteriorPenalty() | give an object"),
    (lambda _: Disc(order=0), "order is 0 | an integer of at least 1 | must be"),
    (lambda _: Disc(order=9), "order is 9 | in 2D at most 8 | up to which methods are tested"),
    (lambda _: Lifted(7).form, "liftorder is 7 | in 3D it must be at most 6 | up to which forms are tested"),
    (lambda _: Disc(foundation=Foundation("(?i)bottom", SOFT)),
     "foundation region is '(?i)bottom' | which NGSolve does not take for a regular expression | give a name or alternatives"),
    (lambda _: Disc(dirichlet={"a(1)": SPRING}, mesh=Renamed("a(1)")),
     "region 'a(1)' is the name of a boundary | letters mean something else | give 'a\\\\(1\\\\)', as re.escape makes it"),
    (lambda _: Disc(assembly="fast"), "assembly is 'fast' | 'facet' or 'skeleton' | choose"),
    (lambda _: Curved(), "the mesh was curved | after the Discretization was made | make a new one"),
    (lambda _: Refined(), "the mesh was refined | after the Discretization was made | make a new one"),
    (lambda _: Parametric(lambda modulus, gap: modulus.Set(1000), lambda solution: solution.stress),
     "Parameter in material: E | was set anew since the solution was computed | set it back"),
    (lambda _: Parametric(lambda modulus, gap: gap.Set(1), lambda solution: Solve(solution.disc)),
     "foundation 'bottom': gap: a GridFunction | was changed after the Discretization was made | make a new one"),
    (lambda _: Added(lambda u, v: BilinearForm(u.space)), "the form has no integrals | with +=, before it is added | give"),
    (lambda _: Quadratic(), "integral 1 of the form is 'Symbolic Energy' | none of those that can be added | write dx"),
    (lambda _: Added(lambda u, v: BilinearForm(u * v * ds)), "integral 1 of the form is 0 | ds alone | ds(skeleton=True"),
    (lambda _: Added(lambda u, v: BilinearForm(Parameter(0) * u * v * dx)),
     "integral 1 of the form is 0 | a Parameter 0 | add it while Parameters are not 0"),
    (lambda _: Added(lambda u, v: BilinearForm((u - u.Other()) * v * ds(skeleton=True))),
     "form has another matrix than it applies | Other() on the boundary | leave Other() out"),
    (lambda _: Added(lambda u, v: BilinearForm((u - u.Other()) * v * dx(skeleton=True)), Disc(Conforming())),
     "form cannot be assembled | between elements of a discontinuous method | write dx"),
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
    (lambda _: WeaklyOverPenalised(penalty="auto"), "penalty is 'auto' | a positive number | give"),
    (lambda _: Disc(WeaklyOverPenalised(), order=2).form, "order is 2 | WOPSIP is of first order | take order=1"),
    (lambda _: Disc(WeaklyOverPenalised(), assembly="skeleton").form,
     "assembly='skeleton' does not apply to WOPSIP | no means on facets | take assembly='facet'"),
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
    (lambda _: Solve(Disc(Conforming())).flux, "method H1 has no numerical flux | a discontinuous one | take")]
