"""Discontinuous Galerkin methods for frictional contact with normal compliance, on NGSolve."""

from ngsolve import Solve

from .discretization import Discretization
from .estimates.adaptive import SolveAdaptive
from .estimates.divided import SolveDivided
from .estimates.error import EstimateError
from .estimates.force import EstimateForce
from .estimates.zonelengths import EstimateZones
from .exceptions import NotConvergedError, ProblemError, SolveInterrupted
from .histories.history import LoadHistory
from .histories.solve import SolveHistory
from .methods.conforming import Conforming
from .methods.lifting import Lifting
from .methods.overpenalised import WeaklyOverPenalised
from .methods.penaltyfree import PenaltyFreeLDG
from .methods.rows import LDG, BassiEtAl, BrezziEtAl, IncompleteInteriorPenalty, InteriorPenalty, NonsymmetricInteriorPenalty
from .problem.foundation import Foundation
from .problem.hypotheses import CheckLaws
from .problem.joint import Joint
from .problem.laws import (ArchardWear, ComplianceLaw, CoulombFriction, FrictionLaw, NormalCompliance, PowerFriction,
                           SlipWeakeningFriction, TrescaFriction)
from .problem.materials import AnisotropicMaterial, HookeMaterial
from .problem.problem import ContactProblem
from .problem.punch import RigidPunch
from .solution.solution import ContactSolution
from .solvers import Contraction, EstimateContraction, MultiStart, NestedNewtonSolver, SemismoothNewtonSolver, UzawaSolver
from .theory.uniqueness import CheckUniqueness

__version__ = "0.2.0"

# What `from ngdgc import *` brings: classes, not the submodules, whose names users and NGSolve have their own use for; and
# NGSolve's own Solve, which calls disc.Solve.
__all__ = ["AnisotropicMaterial", "ArchardWear", "BassiEtAl", "BrezziEtAl", "CheckLaws", "CheckUniqueness", "ComplianceLaw",
           "Conforming", "ContactProblem", "ContactSolution", "Contraction", "CoulombFriction", "Discretization",
           "EstimateContraction", "EstimateError", "EstimateForce", "EstimateZones", "Foundation", "FrictionLaw",
           "HookeMaterial", "IncompleteInteriorPenalty", "InteriorPenalty", "Joint", "LDG", "Lifting", "LoadHistory",
           "MultiStart", "NestedNewtonSolver", "NonsymmetricInteriorPenalty", "NormalCompliance", "NotConvergedError",
           "PenaltyFreeLDG", "PowerFriction", "ProblemError", "RigidPunch", "SemismoothNewtonSolver", "SlipWeakeningFriction",
           "Solve", "SolveAdaptive", "SolveDivided", "SolveHistory", "SolveInterrupted", "TrescaFriction", "UzawaSolver",
           "WeaklyOverPenalised"]
