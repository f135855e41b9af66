"""Foundations that are rigid punches: how far their motions move each contact point, and what presses them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..contracts import Array
from ..data.coefficients import ValuesAt
from ..exceptions import ProblemError
from ..mesh.facets import RigidMotionsAt
from ..problem.foundation import Foundation
from ..problem.frames import Cartesian
from ..problem.punch import RigidPunch
from .parts import ContactPart

CONSTANT = 1e-12    # relative difference of values that are one


@dataclass(frozen=True, kw_only=True, eq=False)
class Punches:
    """The rigid punches among foundations with n contact points in d dimensions; m of their motions are to be found.

    regions : of the punches;  motions : (punches, modes), the prescribed ones, 0 where a punch is held or free [length], [1]
    free : (m, 2), punch and mode of the motions to be found;  units : (m,) of these, 1 or, of a rotation, over the extent
    traces : (m, n, d), displacement of the points by a unit of each;  loads : (m,), forces along them, moments over the extent
    placed : (n, d), displacement of the points by the prescribed motions [length]
    """

    regions: tuple[str, ...]
    motions: Array
    free: Array
    units: Array
    traces: Array
    loads: Array
    placed: Array

    @classmethod
    def Of(cls, parts: Sequence[ContactPart], coordinates: Array, meshpoints: Any, mesh: Any,
           frame: Cartesian) -> Punches | None:
        """Those of the parts of Gamma_C, or None if there are none; meshpoints : at which data are evaluated, (n,)."""
        punched = [part for part in parts if part.foundation.punch is not None]
        if not punched:
            return None
        dim = coordinates.shape[1]
        motions, free, units, traces, loads = np.zeros((len(punched), 3 * dim - 3)), [], [], [], []
        placed = np.zeros_like(coordinates)
        for place, part in enumerate(punched):
            punch, region = part.foundation.punch, mesh.Boundaries(part.foundation.boundary)
            name, here = f"foundation {part.foundation.boundary!r}", part.points
            modes = _Modes(punch, coordinates[here])
            _CheckModes(punch, name, frame, dim)
            extent = float(np.ptp(coordinates[here], axis=0).max()) or 1.0
            for mode, (load, motion) in enumerate(zip(punch.Loads(), punch.Motions())):
                if motion is not None:
                    motions[place, mode] = _Constant(motion, meshpoints[here], f"{name}: motion of punch", region)
                    placed[here] += motions[place, mode] * modes[mode]
                if load is not None:
                    unit = 1.0 if mode < dim else 1 / extent
                    trace = np.zeros_like(coordinates)
                    trace[here] = unit * modes[mode]
                    traces.append(trace)
                    loads.append(unit * _Constant(load, meshpoints[here], f"{name}: load of punch", region))
                    free.append((place, mode))
                    units.append(unit)
        return cls(regions=tuple(part.foundation.boundary for part in punched), motions=motions,
                   free=np.array(free, dtype=int).reshape(-1, 2), units=np.array(units),
                   traces=np.array(traces).reshape(-1, *coordinates.shape), loads=np.array(loads), placed=placed)

    @property
    def count(self) -> int:
        """How many motions are to be found."""
        return len(self.loads)

    def Whole(self, found: Array | None) -> Array:
        """Displacement and rotation of all punches, (punches, modes) [length], [1], from what was found (m,); None: nothing."""
        motions = self.motions.copy()
        if found is not None:
            motions[self.free[:, 0], self.free[:, 1]] = self.units * found
        return motions

    def At(self, foundation: Foundation, found: Array | None, coordinates: Array) -> Array:
        """Displacement of the foundation at points (p, d), with what was found (m,), (p, d) [length]; 0 if it is no punch."""
        if foundation.punch is None:
            return np.zeros_like(coordinates)
        motion = self.Whole(found)[self.regions.index(foundation.boundary)]
        return np.asarray(np.tensordot(motion, _Modes(foundation.punch, coordinates), axes=1))

    def Found(self, motions: Array) -> Array:
        """(m,) of these motions (punches, modes)."""
        return np.asarray(motions[self.free[:, 0], self.free[:, 1]] / self.units)

    def Excess(self, traction: Array, weights: Array) -> Array:
        """Loads without what a traction (n, d) of the body holds against them, (m,), zero in balance."""
        return self.loads + np.einsum("mnd,nd,n->m", self.traces, traction, weights)

    def Words(self) -> list[str]:
        """Words for the motions to be found, (m,)."""
        dim = self.placed.shape[1]
        words = [f"translation of the punch {{}} along {axis}" for axis in "xyz"[:dim]]
        words += ["rotation of the punch {}"] if dim == 2 else [f"rotation of the punch {{}} about {axis}" for axis in "xyz"]
        return [words[mode].format(repr(self.regions[place])) for place, mode in self.free]


def _Modes(punch: RigidPunch, coordinates: Array) -> Array:
    """Displacements of points (p, d) by a unit of each rigid motion, rotations about the punch's point, (modes, p, d)."""
    return RigidMotionsAt(coordinates - (0 if punch.about is None else np.array(punch.about, dtype=float)))


def _CheckModes(punch: RigidPunch, name: str, frame: Cartesian, dim: int) -> None:
    """Raise ProblemError for motions that a body of revolution does not make."""
    turning = [entry for mode, pair in enumerate(zip(punch.Loads(), punch.Motions())) for entry in pair
               if entry is not None and mode not in range(3 * dim - 3)[frame.rigid]]
    if turning:
        raise ProblemError(f"{name}: the punch of a body of revolution moves along the axis alone; give force=(None, F) or "
                           "displacement=(None, a)")


def _Constant(value: Any, points: Any, name: str, region: Any) -> float:
    """The one value of a number or CoefficientFunction; ProblemError if it varies in space."""
    values = ValuesAt(value, points, name, region)
    if np.ptp(values) > CONSTANT * np.abs(values).max():
        raise ProblemError(f"{name} varies from {values.min():g} to {values.max():g} along the foundation, and a rigid body "
                           "has one; give a number, or a CoefficientFunction of Parameters")
    return float(values[0])
