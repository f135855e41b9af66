"""The solution of a time that has passed: from what a history keeps of its state."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from ..contracts import Array, LinearProblem
from ..discrete.problem import DiscreteProblem
from ..discrete.punched import Enlarged
from ..discrete.response import ContactResponse
from ..solution.history import Step
from ..solution.solution import ContactSolution
from ..solvers.driver import SolutionOf
from ..solvers.newton.setting import Setting
from .loading import Loading, Instant
from .states import LoadState


@contextmanager
def Restoring(parameter: Any) -> Iterator[None]:
    """A time in which a Parameter may be set."""
    value = parameter.Get()
    try:
        yield
    finally:
        parameter.Set(value)


class Recall:
    """Makes the ContactSolution of a `LoadState`, where its coefficients are not kept by one application of an inverse.

    disc : with the data of some time;  response : `ContactResponse` whose inverse serves, None: one is made when it is needed
    """

    def __init__(self, disc: DiscreteProblem, parameter: Any) -> None:
        self.disc, self.parameter = disc, parameter
        self.response: ContactResponse | None = None

    def __call__(self, state: LoadState) -> ContactSolution:
        disc, vector, traction = self.Disc(state), state.vector, state.traction
        if vector is None:
            equations, relative = Enlarged(disc), state.displacement - disc.contact.found
            found = self._Response(equations, relative, state.traction).Meet(relative, state.traction)[0]
            # Round-off of the matrix is no traction where there is none.
            traction = np.where(np.any(traction, axis=1)[:, None], found.traction, traction)
            vector = found.vector[:disc.space.ndof]
        increment = state.increment
        steps = [Step(1, 0.0, increment.residual, increment.solves, increment.seconds)]
        return SolutionOf(disc, vector, traction, history=steps, solver=f"SolveHistory at time {state.time:g}")

    def Disc(self, state: LoadState) -> DiscreteProblem:
        """The discrete problem with the data of the time of a state, and slip from the state before."""
        with self.disc.lock, Restoring(self.parameter), self.disc.state.Restored():
            self.parameter.Set(state.time)
            disc = self.disc.Current()
        disc, punches = disc.After(*state.before), disc.contact.punches
        return disc if punches is None or state.punches is None else disc.Moved(punches.Found(state.punches))

    def Instant(self, state: LoadState) -> Instant:
        """The state as one from which the next increment begins."""
        solution = self(state)
        return Instant(disc=solution.disc, loading=Loading.Of(solution.disc), displacement=solution.displacement,
                      traction=solution.traction, vector=solution.vector, residual=state.increment.residual)

    def _Response(self, equations: LinearProblem, displacement: Array, traction: Array) -> ContactResponse:
        if self.response is None:
            setting = Setting.Of(equations)
            point = setting.graph.At(setting.graph.Coordinates(displacement, traction))
            self.response = ContactResponse(equations, setting.Stiffness(point))
        return self.response.Moved(equations)
