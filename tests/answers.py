"""Answers of students to the exercises: the right ones of the notebooks, and wrong ones with words of their hints."""

import math
import runpy
from functools import cache
from pathlib import Path

import numpy as np

from ngdgc import CoulombFriction, HookeMaterial, NormalCompliance
from ngdgc.exercises import fluxes, liftings
from ngdgc.methods import registry as methods
from ngdgc.studies import locking
from ngdgc.studies.table3 import PUBLISHED

SOLUTIONS = {path.stem[:2]: path for path in (Path(__file__).parents[1] / "docs" / "notebooks" / "solutions").glob("*.py")}
PAD = HookeMaterial(E=5, nu=0.45)
MODULUS = PAD.lam + 2 * PAD.mu


@cache
def Solution(name):
    return runpy.run_path(str(SOLUTIONS[name[:2]]))[f"answer_{int(name[3:])}"]


def Scaled(name, factor):
    """The right function times a factor."""
    return lambda *data: factor * np.asarray(Solution(name)(*data))


class Piecewise:
    """The foam with parts to be spoilt."""

    def __init__(self, k1, k2, d, *, clip=True, meet=True):
        self.k1, self.k2, self.d, self.clip, self.meet = k1, k2, d, clip, meet

    def Pressure(self, r):
        soft = self.k1 * (np.maximum(r, 0) if self.clip else r)
        return np.where(r < self.d, soft, self.meet * self.k1 * self.d + self.k2 * (r - self.d))

    def PressureDerivative(self, r):
        return np.where(r < self.d, self.k1, self.k2)


def Rest(parts, *without):
    """The root of the sum of the squares of all parts but some."""
    return math.hypot(*(share for name, share in parts.items() if name not in without))


# Answers as students give them, and words of the hint that must come.
WRONG = {
    "01.1": [(0.3 / 0.2 + 0.3 * 40 / MODULUS, "forgot the gap"), (0.5 + 0.3 / 0.2 + 0.3 * 40 / 5, "Young's modulus"),
             (20.0, "three things"), ("2 mm", "Wrong type"), (-(0.5 + 0.3 / 0.2 + 0.3 * 40 / MODULUS), "Wrong sign"),
             ((0.5 + 0.3 / 0.2 + 0.3 * 40 / MODULUS) / 1000, "Wrong unit"), ([1.0, 2.0], "Wrong shape")],
    "01.2": [(lambda P, k, m, g: (P / k) ** (1 / m), "forgot the gap"), (lambda P, k, m, g: g + (P / k) ** m, "inverted"),
             (lambda P, k, m, g: P[0], "Wrong shape"), (lambda P, k, m: P, "raises TypeError"), (3.0, "function itself"),
             (lambda P, k, m, g: None, "is there a return"), (lambda P, k, m, g: np.nan * P, "Not finite")],
    "01.3": [(5 / 40, "Young's modulus"), (MODULUS * 40, "longer pad"), (2 * MODULUS / 40, "Wrong factor"),
             (1000 * MODULUS / 40, "Wrong unit")],
    "01.4": [(("a", 1), "balance"), (("c", 3), "not the displacement"), (("b", 3), "reason is not"), ("b", "as a pair"),
             (("d", 2), "Statements are")],
    "02.1": [(lambda n, k: n**2 * (k + 1) * (k + 2), "two components"), (lambda n, k: 2 * (n * k + 1) ** 2, "continuous"),
             (lambda n, k: 4 * n**2 * (k + 1) ** 2, "of a square")],
    "02.2": [(lambda n, k: 2 * (n + 1) ** 2, "right for k = 1"), (lambda n, k: 2 * (n * k) ** 2, "n + 1 ends"),
             (lambda n, k: 2 * n**2 * (k + 1) * (k + 2), "discontinuous")],
    "02.3": [(lambda e, h: np.log2(e[:-1] / e[1:]), "halved"), (Scaled("02.3", -1), "Wrong sign"),
             (lambda e, h: np.log(e) / np.log(h), "Wrong shape")],
    "02.4": [(("a", 1), "GlobalImbalance"), (("c", 1), "single element"), (("b", 2), "reason is not")],
    "03.1": [(lambda: fluxes.Matrix(methods.InteriorPenalty(penalty=30)), "interior penalty itself"),
             (lambda: Solution("03.1").T, "the other term"),
             (lambda: fluxes.Matrix(methods.IncompleteInteriorPenalty(penalty=30)), "incomplete")],
    "03.2": [(lambda: fluxes.Matrix(methods.InteriorPenalty(penalty=31)) * 30
              - fluxes.Matrix(methods.InteriorPenalty(penalty=30)) * 30, "tensor jump"),
             (lambda: 2 * Solution("03.2"), "Wrong factor"), (lambda: 0 * Solution("03.2"), "Zero everywhere"),
             (lambda: Solution("03.2")[:-1], "Wrong shape")],
    "03.3": [(lambda mean, w, n, ratio: mean - ratio[:, None] * w, "vector jump"),
             (lambda mean, w, n, ratio: 2 * mean - Solution("03.3")(mean, w, n, ratio), "pulls the sides together"),
             (lambda mean, w, n, ratio: Solution("03.3")(mean, w, n, ratio).T, "interchanged"),
             (lambda mean, w, n, ratio: mean - ratio * w, "raises ValueError")],
    "03.4": [(lambda: fluxes.Matrix(methods.BassiEtAl(penalty=2)), "That is Bassi"),
             (lambda: fluxes.Matrix(methods.LDG(penalty=2)), "That is LDG"),
             (lambda: fluxes.Matrix(methods.BrezziEtAl(penalty=1)), "penalty factor")],
    "04.1": [(Scaled("04.1", -1), "minus in the definition"), (Scaled("04.1", 2), "half goes to the neighbour"),
             (lambda jump, length, area: -jump * area[:, None, None] / length[:, None, None] / 2, "gives its area")],
    "04.2": [([3, 3], "less does"), ([2, 2], "parallelogram"), ([3, 2], "interchanged"), (2, "Wrong shape")],
    "04.3": [(lambda: liftings.FACETS, "bound of the theory"), (lambda: 1 / Solution("04.3"), "inverse"),
             (lambda: 10 * Solution("04.3"), "Wrong unit")],
    "04.4": [(("a", 1), "zero eigenvalues"), (("c", 3), "l = 0 again"), (("b", 3), "two forms agree")],
    "05.1": [(lambda p, d, g, k, c: k * (d - c * p - g), "does not pull"),
             (lambda p, d, g, k, c: k * np.maximum(d - c * p, 0), "forgot the gap"),
             (lambda p, d, g, k, c: k * np.maximum(d + c * p - g, 0), "mind the sign")],
    "05.2": [(lambda q, tol: np.log(tol) / np.log(q), "A step is done or not"),
             (lambda q, tol: np.floor(np.log(tol) / np.log(q)), "wrong direction"),
             (lambda q, tol: 1 + np.floor(np.log(tol) / np.log(q)), "reached exactly"),
             (lambda q, tol: np.ceil(np.log(q) / np.log(tol)), "other way round")],
    "05.3": [(lambda m: np.clip(m, -1, 1), "a square"), (lambda m: m, "Nothing was projected"),
             (lambda m: Solution("05.3")(m).T, "interchanged")],
    "05.4": [(("a", 1), "largest displacement"), (("b", 3), "go to zero"), (("c", 3), "without friction")],
    "06.1": [(lambda p, t, b: np.where(np.abs(t) < b, 1, 2), "forgot separation"),
             (lambda p, t, b: np.where(p > 0, np.where(t < b, 1, 2), 0), "has a sign"),
             (lambda p, t, b: np.where(p > 0, np.where(np.abs(t) < b, 2, 1), 0), "interchanged")],
    "06.2": [(lambda r, k, m: np.where(r > 0, k * np.abs(r) ** (m - 1), 0), "comes down"),
             (lambda r, k, m: k * m * np.abs(r) ** (m - 1), "derivative is zero"),
             (lambda r, k, m: k * m * np.maximum(r, 0) ** (m - 1), "Try m = 1"),
             (lambda r, k, m: k * m * np.maximum(r, 0) ** (m - 1) if r > 0 else 0, "use np.where"),
             (lambda r, k, m: k * m * math.pow(max(r[0], 0), m), "those of numpy"),
             (lambda r, k, m: k * m * np.sqrt(np.where(r < 0, np.nan, r)) ** (m - 1), "Not finite")],
    "06.3": [(lambda r, g, d, c, k, m: r - (r + g + c * k * np.maximum(r, 0) ** m - d)
              / (1 + c * k * m * np.maximum(r, 0) ** (m - 1)), "Try m = 1"),
             (lambda r, g, d, c, k, m: d - g - c * k * np.maximum(r, 0) ** m, "slope of the body"),
             (lambda r, *data: 2 * r - Solution("06.3")(r, *data), "subtracts"),
             (lambda r, g, *data: Solution("06.3")(r, 0 * g, *data), "forgot the gap")],
    "06.4": [(("a", 2), "history"), (("b", 1), "straight line"), (("c", 1), "pieces")],
    "07.1": [(lambda E, nu: E * nu / ((1 + nu) * (1 - 2 * nu)), "plane strain"),
             (lambda E, nu: E / (1 - nu**2), "whole modulus"),
             (lambda E, nu: E / 2 / (1 + nu), "That is mu")],
    "07.2": [(lambda: np.log(np.divide(PUBLISHED["4.2"][:-1], PUBLISHED["4.2"][1:])), "Divide by log 2"),
             (lambda: np.log2(np.divide(PUBLISHED["4.1"][:-1], PUBLISHED["4.1"][1:])), "Example 4.1"),
             (lambda: -np.array(Solution("07.2")), "Wrong sign"), (lambda: Solution("07.2")[:2], "Wrong shape")],
    "07.3": [(200 * 4.45, "Turn it around"), (1 / 190, "vertical"), (1 / 900, "not from 0 to 1"),
             (100 / 890, "not per cent")],
    "07.4": [(("a", 1), "without friction"), (("c", 1), "incompressible"), (("b", 2), "wrong law")],
    "08.1": [(lambda r, p, gamma: p - gamma * np.maximum(r, 0), "normal compliance"),
             (lambda r, p, gamma: p * r, "two inequalities"), (lambda r, p, gamma: -gamma * r, "positive part is missing"),
             (lambda r, p, gamma: np.where(p > 0, np.minimum(p, -gamma * r), 0), "no solution either"),
             (Scaled("08.1", -1), "Wrong sign")],
    "08.2": [(lambda e, k: np.log10(e[:-1] / e[1:]), "grow tenfold"), (Scaled("08.2", -1), "Wrong sign"),
             (lambda e, k: np.log(e[:-1] / e[1:]), "Divide by the logarithm")],
    "08.3": [(lambda q, k, gamma: k * q / (k + gamma), "does not pull"),
             (lambda q, k, gamma: np.maximum(q, 0), "infinite stiffness"),
             (lambda q, k, gamma: np.maximum(q, 0) / (k + gamma), "penetration")],
    "08.5": [(lambda p, r, weights: np.sum(weights * p), "roller"), (lambda p, r, weights: np.sum(weights * p * r), "wedge"),
             (lambda p, r, weights: np.pi * np.sum(weights * p * r), "circumference")],
    "08.4": [(("b", 1), "second line"), (("c", 3), "finest meshes"), (("a", 2), "energy error")],
    "09.1": [(lambda E, nu: E * nu / (1 - nu**2), "plane stress"), (lambda E, nu: E * nu / (1 - 2 * nu), "1 + nu is missing"),
             (lambda E, nu: E / (3 - 6 * nu), "bulk modulus")],
    "09.2": [([0.5, 3, 4 / 6], "two components"), ([1, 6, 4], "three coefficients"), ([2, 12, 8 / 3], "two triangles")],
    "09.3": [(lambda: 1 / Solution("09.3"), "not first by last"),
             (lambda: locking.Study(methods.LDG(), order=2, n=4, lam=(1, 1e4)).factor, "Hardly any growth"),
             (lambda: locking.Study(methods.Conforming(), order=2, n=8, lam=(1, 1e4)).factor, "n = 8")],
    "09.4": [(("a", 1), "balances and converges"), (("c", 3), "table of forces"), (("b", 1), "balanced")],
    "10.1": [(Piecewise(20.0, 500.0, 0.1, clip=False), "Pressure: A foundation does not pull"),
             (Piecewise(20.0, 500.0, 0.1), "PressureDerivative: Without contact"),
             (Piecewise(20.0, 500.0, 0.1, meet=False), "jumps"), (Piecewise, "make an object"),
             (3.0, "has no method Pressure")],
    "10.2": [(CoulombFriction(0.4), "That is Coulomb"), (NormalCompliance(1), "has no method Bound")],
    "10.3": [(lambda p, s, c, t: np.minimum(c * p, t), "a sign is missing"),
             (lambda p, s, c, t: c * p * np.sign(s), "limit is missing"),
             (Scaled("10.3", -1), "along the slip"), (lambda p, s, c, t: np.minimum(c * p, t) * s, "not its size")],
    "10.4": [(("a", 1), "every point in contact"), (("c", 3), "wrong sign would"), (("b", 2), "stagnate")],
    "11.1": [(lambda shares: sum(math.sqrt(share) for share in shares), "goes to infinity"),
             (lambda shares: math.sqrt(max(shares)), "goes to 0"), (lambda shares: sum(shares), "not its root"),
             (lambda shares: np.sqrt(np.mean(shares)), "A mean"), (lambda shares: 1.0, "it goes to infinity"),
             (lambda shares: 10 * np.sqrt(np.sum(shares)), "far from 1"), (lambda shares: 0, "it goes to 0"),
             (lambda shares: -np.sqrt(np.sum(shares)), "not negative"), (np.sqrt, "Wrong shape"),
             (lambda shares: np.nan, "Not finite"), (lambda parts: parts["law"], "raises IndexError"),
             (0.3, "function itself")],
    "11.2": [(lambda parts: math.hypot(*parts.values()), "Nothing is left out"),
             (lambda parts: math.hypot(parts["law"], parts["feasibility"]), "what is to be left out"),
             (lambda parts: parts["law"], "goes to 0.  It should stay near 1"),
             (lambda parts: Rest(parts, "law"), "no law can give"),
             (lambda parts: Rest(parts, "feasibility"), "graph of the law"),
             (lambda parts: parts["stress"] + parts["feasibility"], "stays where it is.  It should go to 0"),
             (lambda parts: Rest(parts, "law", "feasibility") ** 2, "root is missing")],
    "11.3": [(lambda parts: math.hypot(*parts.values()), "Nothing is left out"),
             (lambda parts: Rest(parts, "stress"), "symmetric"),
             (lambda parts: Rest(parts, "skew"), "still in"), (lambda parts: Rest(parts, "jumps"), "they stay"),
             (lambda parts: Rest(parts, "stress", "skew", "jumps"), "so do the jumps"),
             (lambda parts: Rest(parts, "stress", "skew", "law") ** 2, "goes to 0.  It should stay near 1")],
    "11.4": [(lambda shares, share: shares > share * shares.max(), "left to chance"),
             (lambda shares, share: ~Solution("11.4")(shares, share), "other way round"),
             (lambda shares, share: np.sort(np.argsort(-shares)[:Solution("11.4")(shares, share).sum()]), "make a mask"),
             (lambda shares, share: shares >= np.sort(shares)[-round(share * len(shares))], "share of the elements"),
             (lambda shares, share: Solution("11.4")(shares, 1 - share), "largest first"),
             (lambda shares, share: Solution("11.4")(shares ** 2, share), "squares already"),
             (lambda shares, share: Solution("11.4")(np.sqrt(shares), share), "not what adds up")],
    "11.5": [(lambda N, e, wanted: N[-1] * e[-1] / wanted, "measure the order"),
             (lambda N, e, wanted: np.interp(wanted, e[::-1], N[::-1]), "straight line through"),
             (lambda N, e, wanted: N[-1] * (e[-1] / wanted) ** (1 / np.log2(e[-2] / e[-1])), "are its square"),
             (lambda N, e, wanted: Solution("11.5")(N, e, wanted) / N[-1], "how many times more"),
             (lambda N, e, wanted: Solution("11.5")(N[::-1], e[::-1], wanted), "straight line through"),
             (lambda N, e, wanted: Solution("11.5")(N, e, [wanted]), "Wrong shape")],
    "11.6": [(("a", 1), "slopes differ"), (("b", 1), "would have shown"), (("c", 2), "picture of the shares"),
             (("c", 3), "does not turn")],
    "12.1": [(lambda Q, P, mu: 1 - Q / (mu * P), "root is missing"), (lambda Q, P, mu: np.sqrt(1 - Q / P), "without the coeff"),
             (lambda Q, P, mu: 1 - np.sqrt(1 - Q / (mu * P)), "that slips"), (Scaled("12.1", -1), "Wrong sign")],
    "12.2": [(lambda s, largest, limit, slide: limit * (1 - (1 - np.maximum(s, 0) / slide) ** 1.5), "as if friction did not"),
             (lambda s, largest, limit, slide: Solution("12.2")(2 * s - largest, largest, limit, slide), "must be halved"),
             (Scaled("12.2", 2), "Wrong factor")],
    "12.3": [(lambda sigma, u, weights: -np.sum(weights * sigma[:-1] * np.diff(u, axis=0)), "at the beginning"),
             (lambda sigma, u, weights: -np.sum(sigma[1:] * np.diff(u, axis=0)), "weights are missing"),
             (lambda sigma, u, weights: -np.sum(weights * sigma * u), "from the state before")],
    "12.4": [(("a", 1), "where it crosses"), (("c", 2), "Look at the sign"), (("b", 1), "however elastic"),
             (("b", 3), "never slips")],
}
