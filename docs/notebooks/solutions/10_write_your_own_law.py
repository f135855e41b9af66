"""Model solutions of notebook 10, laws of one's own."""

from dataclasses import dataclass

import numpy as np

from ngdgc import ComplianceLaw, FrictionLaw


@dataclass(frozen=True)
class Foam(ComplianceLaw):
    """A soft layer of thickness d [length] on a harder base, k1 and k2 [stress/length]."""

    k1: float
    k2: float
    d: float

    def Pressure(self, r):
        depth = np.maximum(r, 0)
        return self.k1 * np.minimum(depth, self.d) + self.k2 * np.maximum(depth - self.d, 0)

    def PressureDerivative(self, r):
        return np.where(r > 0, np.where(r < self.d, self.k1, self.k2), 0)


@dataclass(frozen=True)
class LimitedFriction(FrictionLaw):
    """p_t = min(coefficient p, strength), strength [stress]."""

    coefficient: float
    strength: float

    def Bound(self, r, p):
        return np.minimum(self.coefficient * p, self.strength)

    def BoundDerivatives(self, r, p):
        return np.zeros_like(r), np.where(self.coefficient * p < self.strength, self.coefficient, 0.0)


# 10.1  The object with its data.
answer_1 = Foam(k1=20.0, k2=500.0, d=0.1)

# 10.2  The smaller of the two bounds at every point.
answer_2 = LimitedFriction(0.4, 5.0)


# 10.3  The bound in the direction of the slip.
def answer_3(p, s, coefficient, strength):
    return np.sign(s) * np.minimum(coefficient * p, strength)


# 10.4  Sticking points never occurred.
answer_4 = ("b", 1)
