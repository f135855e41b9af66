"""Iterations for the contact problem: one driver, one module per iteration."""

from .contraction import Contraction, EstimateContraction
from .uzawa import UzawaSolver
