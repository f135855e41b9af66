"""What `SolveHistory` returns: the states along the times, their forces and energies."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from os import PathLike
from typing import Any

import numpy as np

from ..contracts import Array, Inverter
from ..exceptions import ProblemError
from ..solution.solution import ContactSolution
from ..tools.calls import ByKeyword
from . import saved
from .recall import Recall
from .states import Increment, LoadState


@ByKeyword
class LoadHistory:
    """The states of a body along times t_1 < ... < t_m, each an increment from the one before: from `SolveHistory`.

    `history[-1]` is a ContactSolution, in which slip counts from the state before; slices are LoadHistories.

    Attributes
    ----------
    disc : Discretization;  parameter : the Parameter that was the time
    times : (m,)
    forces : {region: (m, d)}, force of every foundation on the body [stress length^(d-1)]
    work : (m,), of loads, prescribed displacements and foundations that move, from rest without gap on; trapezoidal rule
    energy : (m,), elastic energy of the body, with what the penalties of its jumps store, and energy of springs and foundations
    dissipation : (m,), cumulated -int sigma_t.(change of u_t), with sigma_t at the end of each increment
    displacement, traction : (m, n, d), u and t at the contact points [length], [stress]
    punches : {region: (m, modes)}, displacements and rotations of rigid punches [length], [1]
    increments : list of `Increment`, what each has cost

    path, worn : (m, n), sum of |change of u_t| over the increments that ended in slip, and the depth worn off [length]
    abrasion : (m,), cumulated int p (change of the depth worn off), the energy that goes with it; trapezoidal rule

    work = energy + dissipation + abrasion up to the increments: the difference halves with them.  Of methods whose matrix is
    not symmetric work and energy of prescribed displacements are not known, nan.

    >>> from ngsolve import CF, Parameter
    >>> from ngdgc import *
    >>> from ngdgc.meshes import RectangleMesh
    >>> t = Parameter(0)
    >>> problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), Foundation("bottom", NormalCompliance(1e4)),
    ...                          dirichlet={"top": CF((0, -0.02 * t))})
    >>> history = SolveHistory(Discretization(problem, LDG(), RectangleMesh(2)), parameter=t, times=[0.5, 1])
    >>> bool(abs(history.work - history.energy).max() < 1e-12), history[-1].converged, len(history[:1])
    (True, True, 1)
    """

    def __init__(self, disc: Any, parameter: Any, states: Sequence[LoadState], recall: Recall | None = None) -> None:
        self.disc, self.parameter, self.states = disc, parameter, tuple(states)
        self.recall = recall or Recall(disc, parameter)

    def __repr__(self) -> str:
        over = f", from {self.times[0]:g} to {self.times[-1]:g}" if self.states else ""
        return f"LoadHistory({self.disc!r}, {len(self)} states{over})"

    def __len__(self) -> int:
        return len(self.states)

    def __getitem__(self, place: Any) -> Any:
        if isinstance(place, slice):
            return LoadHistory(self.disc, self.parameter, self.states[place], self.recall)
        try:
            return self.recall(self.states[place])
        except (IndexError, TypeError) as error:
            raise ProblemError(f"history[{place!r}]: there are {len(self)} states; give an integer from {-len(self)} to "
                               f"{len(self) - 1}, or a slice") from error

    def __iter__(self) -> Iterator[ContactSolution]:
        return (self.recall(state) for state in self.states)

    def Last(self) -> LoadState:
        """The last state, with the coefficients of its displacement."""
        state = self.states[-1]
        return state if state.vector is not None else replace(state, vector=self[-1].vector)

    def _Numbers(self, name: str) -> Array:
        return np.array([getattr(state, name) for state in self.states], dtype=float)

    @property
    def times(self) -> Array:
        return self._Numbers("time")

    @property
    def work(self) -> Array:
        return self._Numbers("work")

    @property
    def energy(self) -> Array:
        return self._Numbers("energy")

    @property
    def dissipation(self) -> Array:
        return self._Numbers("dissipation")

    @property
    def displacement(self) -> Array:
        return self._Points("displacement")

    @property
    def traction(self) -> Array:
        return self._Points("traction")

    @property
    def abrasion(self) -> Array:
        return self._Numbers("abrasion")

    @property
    def path(self) -> Array:
        return np.array([state.after.path for state in self.states]).reshape(len(self), -1)

    @property
    def worn(self) -> Array:
        return np.array([state.after.worn for state in self.states]).reshape(len(self), -1)

    def _Points(self, name: str) -> Array:
        return np.array([getattr(state, name) for state in self.states]).reshape(-1, *self.disc.contact.normals.shape)

    @property
    def forces(self) -> dict[str, Array]:
        contact, traction = self.disc.contact, self.traction
        return {part.foundation.boundary: -np.einsum("n,mnd->md", contact.weights[part.points], traction[:, part.points])
                for part in contact.parts}

    @property
    def punches(self) -> dict[str, Array]:
        if (punches := self.disc.contact.punches) is None:
            return {}
        motions = np.array([state.punches for state in self.states]).reshape(len(self), *punches.motions.shape)
        return {region: motions[:, place] for place, region in enumerate(punches.regions)}

    @property
    def increments(self) -> list[Increment]:
        return [state.increment for state in self.states]

    def Save(self, folder: str | PathLike[str]) -> None:
        """Write the history into `folder`, as `ContactSolution.Save` does its last state, which `ContactSolution.Load` reads.

        Raises ProblemError if there is no state, or for what that raises it.
        """
        if not len(self):
            raise ProblemError("the history has no state yet; save one that has")
        saved.KeepStates(self[-1], self.states, folder)

    @classmethod
    def Load(cls, folder: str | PathLike[str], problem: Any, *, parameter: Any, added: Sequence[Any] = (),
             inverse: str | Inverter | None = None) -> LoadHistory:
        """The history saved in `folder`; the problem, with the Parameter on which its data depend, is given again.

        added, inverse : as for `ContactSolution.Load`.  The other states are found again when they are asked for.

        Raises ProblemError if the folder holds no history, or one of another problem: the last state is compared.
        """
        disc, states = saved.ReadStates(folder, problem, parameter, added, inverse)
        return cls(disc, parameter, states)
