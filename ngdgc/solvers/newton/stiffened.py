"""The body with a stiffness of Gamma_C in its matrix: its answer to a point of the graph, and the steps that this asks for."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ...contact.equilibrium import Equilibrium
from ...contact.graph import GraphPoint, Scales
from ...contracts import Array, LinearProblem
from ...discrete.response import Apply, ContactResponse
from .pointwise import PointwiseEquation
from .recycling import Recycled
from .setting import Setting

NEAR = 0.35         # S at one point, in units of 1/gamma; met within a factor of 3 on all meshes tried
LINEAR = 200        # applications of an inverse for one linear equation


@dataclass(frozen=True, kw_only=True, eq=False)
class NewtonState:
    """A point of the graph with F there (n, d), its merit (`StiffenedBody.Merit`), and the equilibrium that it leads to.

    body : that answered;  base : the first equilibrium of the same load, from which others are computed
    """

    body: StiffenedBody
    point: GraphPoint
    F: Array
    merit: float
    equilibrium: Equilibrium
    base: Equilibrium

    def To(self, point: GraphPoint) -> NewtonState:
        """The state at another point of the graph, under the same load."""
        return self.body.Evaluate(point, base=self.base, load=self.base.load)

    def At(self, q: Array) -> NewtonState:
        """The state at the point of the graph that belongs to q, (n, d)."""
        return self.To(self.body.setting.graph.At(q))

    def Renewed(self) -> NewtonState:
        """The same state with the stiffness of the law there in the matrix."""
        return self.body.Renewed(self.point).Evaluate(self.point, base=self.base, load=self.base.load)

    def Error(self) -> float:
        """Largest difference between the point of the graph and the equilibrium, in displacement and traction, no unit."""
        uscale, tscale = Scales(self.body.setting.contact, self.equilibrium.displacement, self.equilibrium.traction)
        return max(np.abs(self.F).max() / uscale, np.abs(Apply(self.body.stiffness, self.F)).max() / tscale)


@dataclass(frozen=True, kw_only=True, eq=False)
class StiffenedBody:
    """A + T' W D T, factorised, with all that has been learnt of S_D.

    predicted : True if D is that of the law where contact is predicted;  stiffness : D (n, d, d), zero where there is none
    response : S_D;  blocks : (n, d, d), what S_D is nearly at one point alone;  recycled : its products so far
    """

    setting: Setting
    predicted: bool
    response: ContactResponse
    stiffness: Array
    blocks: Array
    recycled: Recycled

    @classmethod
    def At(cls, setting: Setting, point: GraphPoint, *, predicted: bool, before: StiffenedBody | None = None) -> StiffenedBody:
        """With the stiffness of the law at the point, if that is a prediction or nothing else holds the body.

        before : what was in use, whose products serve on
        """
        (n, dim), D = setting.contact.normals.shape, setting.Stiffness(point) if predicted or not setting.held else None
        response, stiffness = ContactResponse(setting.disc, D), np.zeros((n, dim, dim)) if D is None else D
        recycled = before.recycled.With(response) if before else Recycled(response, setting.contact.weights)
        blocks = np.asarray(np.linalg.inv(stiffness + (setting.scale / NEAR)[:, None, None] * np.eye(dim)), dtype=float)
        return cls(setting=setting, predicted=predicted, response=response, stiffness=stiffness, blocks=blocks,
                   recycled=recycled)

    def Renewed(self, point: GraphPoint) -> StiffenedBody:
        """With the stiffness of the law at another point, where contact is predicted."""
        return self.At(self.setting, point, predicted=True, before=self)

    def Moved(self, disc: LinearProblem) -> StiffenedBody:
        """The same matrix for a problem with another right-hand side."""
        response = self.response.Moved(disc)
        return replace(self, setting=replace(self.setting, disc=disc), response=response, recycled=self.recycled.With(response))

    def Evaluate(self, point: GraphPoint, *, base: Equilibrium | None = None, load: float = 1.0) -> NewtonState:
        """The state at a point of the graph, by one application of the inverse.

        base : an equilibrium of this load, of which the difference is computed and remembered.  From the last one round-off
            would add up, and be kept from where the iteration had gone far astray
        """
        found, s, response = self.response.Meet(point.displacement, point.traction, load=load, near=base)
        if s is not None and response is not None:
            self.recycled.Remember(s, response)
        F = point.displacement - found.displacement
        return NewtonState(body=self, point=point, F=F, merit=self.Merit(F), equilibrium=found, base=base or found)

    def Merit(self, F: Array) -> float:
        """|F|^2 in L2(Gamma_C); where nothing but the foundation holds the body, the energy of F in it and in D, over gamma.

        A soft foundation lets the body move by far more than it slips: of |F|^2 the slip would be round-off.  In tractions
        slip would weigh so much that no motion is let through.  A large D hides in F what is out of balance.
        """
        weights, holding = self.setting.contact.weights[:, None], self.setting.holding
        if holding is None:
            return float(np.sum(weights * F ** 2))
        return float(np.sum(weights * F * Apply(holding.slope + self.stiffness / self.setting.scale[:, None, None], F)))

    def Equation(self, point: GraphPoint, least: float | None = None) -> PointwiseEquation:
        """Newton's equation at a point; dt/dq is raised to the part `least` of what holds the body."""
        holding = self.setting.holding
        raised = None if least is None or holding is None else least * holding.slope
        return PointwiseEquation(point, self.setting.scale, self.stiffness, self.blocks, least=raised)

    def Direction(self, state: NewtonState, forcing: float, least: float | None = None) -> Array:
        """Newton's step in q, (n, d), to a relative residual of its equation."""
        equation = self.Equation(state.point, least)
        s, image = self.recycled.Solve(equation.Local, -Apply(equation.P, state.F), tol=forcing, maxiter=LINEAR)
        return equation.Step(state.F, image - Apply(self.blocks, s))
