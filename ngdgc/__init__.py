"""Discontinuous Galerkin methods for frictional contact with normal compliance, on NGSolve."""

from ngsolve import Solve

from .discretization import Discretization
from .elasticity import AnisotropicMaterial, HookeMaterial
from .exceptions import NotConvergedError, ProblemError, SolveInterrupted
from .foundation import Foundation
from .hypotheses import CheckLaws
from .laws import (ComplianceLaw, CoulombFriction, FrictionLaw, NormalCompliance,
                   PowerFriction, SlipWeakeningFriction, TrescaFriction)
from .lifting import Lifting
from .methods import (LDG, BassiEtAl, BrezziEtAl, Conforming, IncompleteInteriorPenalty, InteriorPenalty,
                      NonsymmetricInteriorPenalty)
from .problem import ContactProblem
from .solution import ContactSolution
from .solvers import (Contraction, EstimateContraction, MultiStart, NestedNewtonSolver, SemismoothNewtonSolver,
                      UzawaSolver)
from .uniqueness import CheckUniqueness

__version__ = "0.1.0"

# What `from ngdgc import *` brings: classes, not the submodules, whose names users and NGSolve have their own use for; and
# NGSolve's own Solve, which calls disc.Solve.
__all__ = ["AnisotropicMaterial", "BassiEtAl", "BrezziEtAl", "CheckLaws", "CheckUniqueness", "ComplianceLaw", "Conforming",
           "ContactProblem", "ContactSolution", "Contraction", "CoulombFriction", "Discretization", "EstimateContraction",
           "Foundation", "FrictionLaw", "HookeMaterial", "IncompleteInteriorPenalty", "InteriorPenalty", "LDG", "Lifting",
           "MultiStart", "NestedNewtonSolver", "NonsymmetricInteriorPenalty", "NormalCompliance", "NotConvergedError",
           "PowerFriction", "ProblemError", "SemismoothNewtonSolver", "SlipWeakeningFriction", "Solve", "SolveInterrupted",
           "TrescaFriction", "UzawaSolver"]
