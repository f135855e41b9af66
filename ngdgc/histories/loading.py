"""What is done to a body at one time, loads, prescribed displacements, gap, and the work of this from one time to the next."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import cast

import numpy as np

from ..contact.boundary import ContactBoundary
from ..contact.graph import Distance, GraphDistance
from ..contact.memory import Memory
from ..contracts import Array
from ..discrete.problem import DiscreteProblem


@dataclass(frozen=True, kw_only=True, eq=False)
class Loading:
    """The data of one time as the discrete problem has them.

    dead : f of body forces, tractions and added forms (ndof,);  prescribed : l of weakly prescribed displacements (ndof,)
    lift : function with the strongly prescribed ones (ndof,);  pull : A lift (ndof,), both None where there are none
    penalty : what the penalty of prescribed displacements is to the body at rest, nan for a form that does not tell, or that is
        not symmetric
    gap : (n,) [length], as it is given, without what is worn off
    pressed : (m,), what presses rigid punches along their motions that are to be found
    """

    dead: Array
    prescribed: Array
    lift: Array | None
    pull: Array | None
    penalty: float
    gap: Array
    pressed: Array

    @classmethod
    def Of(cls, disc: DiscreteProblem) -> Loading:
        none = np.zeros(len(disc.load))
        loads = {weak: sum((load for (kind, _), load in disc.loads.items() if (kind == "prescribed") == weak), none)
                 for weak in (False, True)}
        lift = disc.prescribed if np.any(disc.prescribed) else None
        punches = disc.contact.punches
        return cls(pressed=np.zeros(0) if punches is None else punches.loads,
                   dead=loads[False], prescribed=loads[True], lift=lift, pull=None if lift is None else disc.Multiply(lift),
                   penalty=_Penalty(disc) if disc.Norm(loads[True]) else 0.0, gap=disc.contact.given)

    @property
    def load(self) -> Array:
        return self.dead + self.prescribed


def _Penalty(disc: DiscreteProblem) -> float:
    form = disc.facetform if disc.method.discontinuous else disc.form
    with disc.state.Restored():
        return float(form.PrescribedEnergy()) if hasattr(form, "PrescribedEnergy") and disc.symmetric else np.nan


@dataclass(frozen=True, kw_only=True, eq=False)
class Instant:
    """A state while the next one is computed.

    disc : with the data of its time, slip from the state before;  displacement, traction : u, t at the contact points (n, d)
    residual : how far they are from the law and equilibrium, relative
    vector : coefficients of u (ndof,), or None where Product has x.u of coefficients x without them
    """

    disc: DiscreteProblem
    loading: Loading
    displacement: Array
    traction: Array
    residual: float
    vector: Array | None = None
    Product: Callable[[Array], float] | None = None

    @cached_property
    def memory(self) -> Memory:
        """What the contact points remember of it."""
        return Memory.Of(self.disc.contact, self.displacement, self.law)

    @cached_property
    def law(self) -> GraphDistance:
        """Where the points are on the graph of the law."""
        return Distance(self.disc.contact, self.displacement, self.traction)

    def Times(self, x: Array) -> float:
        """x.u of coefficients x (ndof,)."""
        return self.disc.Product(x, cast(Array, self.vector)) if self.Product is None else self.Product(x)

    def Reaction(self, other: Loading) -> float:
        """What the reactions to strongly prescribed displacements do along those of a loading."""
        if other.lift is None or other.pull is None:
            return 0.0
        contact = self.disc.contact
        return (self.Times(other.pull) - float(self.loading.load @ other.lift)
                + float(np.vdot(contact.Load(self.traction), other.lift)))

    @property
    def moved(self) -> Array | float:
        """How far rigid punches have moved at the contact points (n, d), or 0."""
        return self.disc.contact.moved

    @property
    def elastic(self) -> float:
        """B_h(u, u)/2 with the displacement prescribed on Gamma_D in its jumps: the energy of the body and of its penalties."""
        loading, weights = self.loading, self.disc.contact.weights[:, None]
        contact = float(np.sum(weights * self.traction * self.displacement))
        return 0.5 * (self.Times(loading.dead - loading.prescribed) - contact + loading.penalty + self.Reaction(loading))


def Abrasion(before: Instant | None, after: Instant) -> float:
    """int p (change of the depth worn off), the energy that goes with it, by the trapezoidal rule [stress length^d]."""
    if before is None:
        return 0.0
    old, new = before.disc.contact, after.disc.contact
    return 0.5 * float(new.weights @ (new.Normal(before.traction + after.traction) * (new.worn - old.worn)))


def Work(before: Instant | None, after: Instant) -> float:
    """Work of loads, prescribed displacements and moved foundations, by the trapezoidal rule; before None: rest without gap."""
    new, contact = after.loading, after.disc.contact
    work = 0.5 * (after.Times(new.dead - new.prescribed) + new.penalty + after.Reaction(new))
    if before is None:
        return work - 0.5 * float(contact.weights @ _Moving(contact, after.traction, new.gap, after.moved))
    old = before.loading
    work += 0.5 * (after.Times(old.dead + old.prescribed) - before.Times(new.dead + new.prescribed)
                   - before.Times(old.dead - old.prescribed) - old.penalty)
    work += 0.5 * (before.Reaction(new) - after.Reaction(old) - before.Reaction(old))
    forces = before.traction + after.traction
    return work - 0.5 * float(contact.weights @ _Moving(contact, forces, new.gap - old.gap, after.moved - before.moved))


def _Moving(contact: ContactBoundary, traction: Array, gap: Array, moved: Array | float) -> Array:
    """What tractions (n, d) do on changes of the gap (n,) and of the place of punches (n, d), (n,) [stress length]."""
    work = contact.Normal(traction) * gap
    return work if contact.punches is None else work + np.sum(traction * moved, axis=1)
