"""The facets on which a method couples displacement weakly, and the numerical flux there (Table 1, first row).

On every set of facets the interior-penalty form is the same three terms,

    - <w(u), {C eps(v)} n> - <w(v), {C eps(u)} n> + <w(u), P(w(v)) n>,        flux = {C eps(u)} n - P(w(u) - w_D) n,

where w is u+ - u- between two elements, u on a clamped boundary and u_n n on a roller, and w_D the prescribed value.  Edge form
of the paper since [v]:q = w(v).(q n) for symmetric q.
"""

from ngsolve import Grad, GridFunction, Sym, ds, dx, specialcf

from .coefficients import Unfolded
from .elasticity import Strain


def _OtherStrain(u):
    """eps(u) of the neighbour, of a trial or test function or a GridFunction."""
    return Sym(Grad(u).Other()) if isinstance(u, GridFunction) else Strain(u.Other())


class Interior:
    """Facets between two elements."""

    region, value = None, None

    def __init__(self, material, mesh, penalty):
        self.material, self.penalty, self.n = material, penalty, specialcf.normal(mesh.dim)
        self.measure = dx(skeleton=True, bonus_intorder=material.bonus)

    def Jump(self, u):
        return u - u.Other()

    def Mean(self, u):
        return 0.5 * (self.material.Stress(Strain(u)) + self.material.OtherStress(_OtherStrain(u))) * self.n

    def Penalty(self, w):
        return self.penalty.Interior(w, self.n) * self.n

    def Flux(self, u):
        """{C eps(u)} n - P(w(u)) n, the traction that acts on the element whose outward normal is n [stress]."""
        return self.Mean(u) - self.Penalty(self.Jump(u))


class Clamped:
    """Boundary facets with all components prescribed."""

    def __init__(self, material, mesh, penalty, region, value):
        self.material, self.penalty, self.n = material, penalty, specialcf.normal(mesh.dim)
        self.region, self.measure = region, ds(skeleton=True, definedon=mesh.Boundaries(region), bonus_intorder=material.bonus)
        self.value = self._Prescribed(value)

    def _Prescribed(self, value):
        return Unfolded(value)

    def Jump(self, u):
        return u

    def Mean(self, u):
        return self.material.Stress(Strain(u)) * self.n

    def Penalty(self, w):
        return self.penalty.Boundary(w, self.n) * self.n

    def Flux(self, u):
        """C eps(u) n - P(w(u) - w_D) n, the traction of the support on the body [stress]."""
        return self.Mean(u) - self.Penalty(self.Jump(u) - self.value)


class Roller(Clamped):
    """Boundary facets with the normal component prescribed; the traction is normal."""

    def _Prescribed(self, value):
        return Unfolded(value) * self.n

    def _Normal(self, vector):
        return (vector * self.n) * self.n

    def Jump(self, u):
        return self._Normal(u)

    def Mean(self, u):
        return self._Normal(super().Mean(u))

    def Penalty(self, w):
        return self._Normal(super().Penalty(w))
