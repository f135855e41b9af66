"""A solution that is spread over the ranks: contact, forces and balance are known to all, fields on the own elements."""

from __future__ import annotations

from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from ngsolve import GridFunction, InnerProduct, Integrate

from ..contracts import Array
from ..data.regions import Matching
from ..exceptions import ProblemError
from ..mesh.facets import VolumePoints
from ..mesh.quadrature import BoundaryQuadrature
from ..solution.resultants import ElementForces, Resultant, Resultants
from ..solution.solution import ContactSolution
from ..solution.storage import Writing
from ..solution.tractions import NumericalTractions
from ..solution.vtkfields import WriteBody
from ..solution.vtkparts import PieceName, WriteList
from ..tools.calls import ByKeyword
from .petsc import Largest, OnAll, OnFirst, Summed
from .picture import Picture
from .saved import KeepParts


ELSEWHERE = {"Along", "At", "Largest", "Moment", "Traction", "facettractions", "flux"}


@ByKeyword
class DistributedSolution(ContactSolution):
    """The ContactSolution on a DistributedMesh.

    What needs all ranks, forces, balance, energy and means, is computed at once, so that no rank waits for another one that
    asks for it; `gfu`, `strain` and `stress` are those of the own elements and their neighbours, on disc.local.mesh.
    """

    def __init__(self, disc: Any, vector: Any, traction: Any, **rest: Any) -> None:
        super().__init__(disc, vector, traction, **rest)
        self.__dict__["displacement"] = disc.contact.Displacement(self.vector)      # zones, report and pictures ask for it
        comm, local = disc.mesh.comm, disc.local
        self._everywhere = disc.numbering.Everywhere(self.vector)
        self.__dict__["_gfu"] = GridFunction(local.space, "u")
        self._gfu.vec.FV().NumPy()[:] = self._everywhere
        part = ContactSolution(local, self._everywhere, self.traction[disc.contact.mine])
        self.__dict__["_resultants"] = _Together(comm, Resultants(part), disc.problem)
        own = local.part.own
        density = Integrate(0.5 * InnerProduct(part.stress, part.strain), local.mesh, order=2 * disc.order + 2,
                            element_wise=True).NumPy()
        self.__dict__["energy"] = float(Summed(comm, density[own].sum()))
        forces = ElementForces(part)
        points = VolumePoints(local.mesh, 2)
        moved, shear = np.abs(np.asarray(part.gfu(points))).max(), disc.problem.material.ShearAt(points).max()
        size = np.ptp(disc.mesh.coarse.ngmesh.Coordinates()[:, :disc.mesh.dim], axis=0).max()
        elastic = Largest(comm, shear) * Largest(comm, moved) * size ** (disc.mesh.dim - 2) or 1.0
        scale = max(Largest(comm, np.abs(forces).max()), elastic)
        self._balance = forces.sum(axis=0).T[own] / scale
        self.__dict__["worst"] = Largest(comm, np.abs(self._balance).max(initial=0))
        modes = np.array([np.concatenate([one.force, one.moment]) for one in self._resultants])
        self._global = float(np.abs(modes.sum(axis=0)).max() / max(np.abs(modes).max(), elastic))
        self._residual = super().EquilibriumResidual()
        self._onregions = Summed(comm, _OnRegions(part, own, len(disc.mesh.coarse.GetBoundaries())))
        self._part, self._picture = part, Picture(self)

    def EquilibriumResidual(self) -> float:
        return self._residual

    def GlobalImbalance(self) -> float:
        return self._global

    def ElementImbalance(self) -> Array:
        """Unbalanced force and moment of the own elements, relative; `worst` is the largest of all ranks."""
        return self._balance

    def Force(self, region: str, *, material: str | None = None) -> Array:
        """Force on the body through a region of its outer boundary, (d,)."""
        if material is not None:
            raise ProblemError(f"material is {material!r}; forces on parts of the body are not known on a DistributedMesh, "
                               "leave it out")
        return self._On(region)[0]

    def Mean(self, region: str) -> Array:
        """Mean displacement of a region of the outer boundary, (d,)."""
        _, moved, area = self._On(region)
        return moved / area[0]

    def _On(self, region: str) -> tuple[Array, Array, Array]:
        found = self._onregions[:, Matching(self.disc.mesh.coarse, region, "boundary")].sum(axis=1)
        if not found[2, 0]:
            raise ProblemError(f"boundary {region!r} is not on the outside, where alone forces are known; give one that is")
        return found[0], found[1], found[2]

    def __getattribute__(self, name: str) -> Any:
        if name in ELSEWHERE:
            raise ProblemError(f"{name} of a solution on a DistributedMesh would need elements of other ranks; take gfu and "
                               "stress on disc.local.mesh, which has the own ones, or Save it and load it on one machine")
        return super().__getattribute__(name)

    @cached_property
    def picture(self) -> ContactSolution:
        """What figures and pages show: a ContactSolution on the coarse mesh, refined to at most `picture.MOST` elements."""
        return self._picture.Solution(self)

    def Save(self, folder: str | PathLike[str]) -> None:
        """Write a file of every rank into a folder that all of them see; all ranks have to call it.

        ContactSolution.Load(folder, problem), on one machine, is the same solution on the whole mesh.  What was saved there
        before is replaced at the end, or kept if that fails.
        """
        with self.state.Restored():
            KeepParts(self, folder)

    def WriteParts(self, path: str | PathLike[str], Write: Any) -> Path:
        """The file (.pvtu) that names those of all ranks, each written by `Write` of its own elements or contact points."""
        comm, body = self.disc.mesh.comm, Write is WriteBody
        path = Path(path)
        path = path.with_suffix(".pvtu") if path.suffix in (".vtu", ".pvtu") else path.with_name(path.name + ".pvtu")
        there = comm.allgather(body or bool(len(self.disc.contact.mine)))

        def WriteOwn() -> None:
            with Writing(path.parent):
                piece = PieceName(path, comm.rank)
                piece.parent.mkdir(parents=True, exist_ok=True)
                if there[comm.rank]:
                    Write(self._part, piece, *[self.disc.local.part.own] * body)

        OnAll(comm, WriteOwn)
        with Writing(path.parent):
            return OnFirst(comm, lambda: WriteList(path, np.flatnonzero(there).tolist()))


def _Together(comm: Any, own: list[Resultant], problem: Any) -> list[Resultant]:
    """The sums over the ranks; those of foundations last, in the order of the problem."""
    total: dict[tuple[str, str | None], Array] = {}
    for found in comm.allgather([(one.kind, one.region, np.concatenate([one.force, one.moment])) for one in own]):
        for kind, region, modes in found:
            total[kind, region] = total.get((kind, region), 0) + modes
    order = [key for key in total if key[0] != "foundation"]
    order += [("foundation", foundation.boundary) for foundation in problem.foundation]
    dim = len(own[0].force) if own else 0
    return [Resultant(kind, region, total[kind, region][:dim], total[kind, region][dim:]) for kind, region in order]


def _OnRegions(part: ContactSolution, own: np.ndarray, count: int) -> Array:
    """Forces, integrals of u and areas over the regions of the coarse mesh, (3, regions, d), the share of the own elements."""
    disc, found = part.disc, np.zeros((3, count, part.disc.mesh.dim))
    quadrature = BoundaryQuadrature.On(disc.facets, ".*", 2 * disc.order + 2)
    facet, region, _ = disc.facets.boundary
    number, mine = quadrature.boundaryelements, own[quadrature.elements]
    there = mine & (region[number] < count)
    moved = quadrature.weights[:, None] * np.asarray(part.gfu(quadrature.inside))
    np.add.at(found[1], region[number][there], moved[there])
    np.add.at(found[2], region[number][there], quadrature.weights[there, None])
    sides = np.unique(number[there])
    np.add.at(found[0], region[sides], NumericalTractions(part).forces[facet[sides]])
    return found
