"""What a body does and what is done to it: the pair that every iteration makes, and every solution keeps."""

from __future__ import annotations

from dataclasses import dataclass

from ..contracts import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Equilibrium:
    """A u = load f - T' W t: a displacement and the traction on Gamma_C that it belongs to, and the multiple of the loads.

    vector : coefficients of u, (ndof,);  displacement, traction : u and t at the contact points, (n, d) [length], [stress]
    motion : of rigid punches (m,), which then is not in `displacement`, or None
    """

    vector: Array
    displacement: Array
    traction: Array
    load: float = 1.0
    motion: Array | None = None
