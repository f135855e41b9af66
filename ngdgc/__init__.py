"""Discontinuous Galerkin methods for frictional contact with normal compliance, on NGSolve."""

from .discretization import Discretization
from .elasticity import AnisotropicMaterial, HookeMaterial
from .exceptions import NotConvergedError, ProblemError, SolveInterrupted
from .foundation import (ComplianceLaw, CoulombFriction, Foundation, FrictionLaw, NormalCompliance, PowerFriction,
                         TrescaFriction)
from .methods import Conforming, InteriorPenalty
from .problem import ContactProblem
from .solution import ContactSolution
from .solvers import Contraction, EstimateContraction, UzawaSolver

__version__ = "0.1.0"
