"""Mistakes in exact solutions, meshes and studies, as in `mistakes`."""

from unittest.mock import patch

import numpy as np
from mistakes import HELD, Disc, Friction, Jointed, Nonsymmetric, On
from netgen.occ import Circle
from ngsolve import CF, x, y
from problems import Example

from ngdgc import LDG, AnisotropicMaterial, CheckUniqueness, Conforming, ProblemError, Solve, TrescaFriction, meshes
from ngdgc.studies import accuracy, convergence, locking
from ngdgc.studies.atlas import solvers as atlas
from ngdgc.studies.bench import ranks, solutions as bench
from ngdgc.theory.consistency import ConsistencyResidual
from ngdgc.exact import AffinePatch, SmoothSlip, WinklerColumn
from ngdgc.theory.lemmas import CriticalPenalty
from ngdgc.meshes import BoxMesh, RectangleMesh, ShapeMesh
from ngdgc.studies.sweep import Violation
from ngdgc.traces import FromTraces, Positive, RigidLimit, ThreeZones


def Meshed(**failing):
    """A disc, while a part of the making of its mesh fails."""
    (name, error), = failing.items()
    with patch.object(meshes, name, side_effect=error):
        return ShapeMesh(Circle((0, 0), 1).Face(), 1, order=2)


def WithoutMpi():
    with patch.object(ranks.subprocess, "run", side_effect=FileNotFoundError("no such file: mpirun")):
        ranks.Measure(ranks.Task(ranks=3, n=1))


STUDIES = [
    (lambda _: WithoutMpi(), "3 ranks came to no result | no such file: mpirun | see the page 'Beyond one machine'"),
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
    (lambda _: ConsistencyResidual(Jointed(), CF((x, y))),
     "the problem has joint 'interface' | a CoefficientFunction u has no jumps | take a problem with foundations alone"),
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
    (lambda _: Meshed(CheckElements=ProblemError("element 3 has a map that folds")),
     "maxh=1 is too large | the curves of the shape | element 3 has a map that folds"),
    (lambda _: Meshed(OCCGeometry=RuntimeError("Meshing failed!")),
     "Netgen finds no mesh of the shape with maxh=1 | Meshing failed! | take a smaller one"),
    (lambda _: ShapeMesh(None, 1), "shape is None | a face or a solid | give"),
    (lambda _: ShapeMesh(Circle((0, 0), 1).Face(), 0), "maxh is 0 | a positive number | give"),
    (lambda _: ShapeMesh(Circle((0, 0), 1).Face(), 1, order=0), "order is 0 | a positive integer | give"),
    (lambda _: RectangleMesh(0), "n is 0 | a positive integer | must be"),
    (lambda _: RectangleMesh(2, upper=80), "lower is (0, 0) and upper is 80 | two corners of 2 coordinates each | give"),
    (lambda _: RectangleMesh(2, upper=(80, -30)), "upper is (80, -30) | all of them larger in upper | give two corners"),
    (lambda _: BoxMesh(2, upper=(1, 1)), "upper is (1, 1) | two corners of 3 coordinates each | give"),
    (lambda _: RectangleMesh(2, cells="hexagon"), "cells is 'hexagon' | one of triangle | choose")]
