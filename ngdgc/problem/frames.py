"""The coordinates in which strain and integrals are written: those of the mesh, or r and z of a body of revolution.

A body of revolution is given by half of its section through the axis, x = r >= 0 and y = z.  Nothing twists, u = (u_r, u_z),
and in the order r, z, theta

    eps(u) = [ sym(grad u)   0   ]          int_body f = int_section f 2 pi r,
             [      0      u_r/r ]

so that forces are those of the whole ring, and C is that of a body in space.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from ngsolve import CF, Grad, GridFunction, Id, IfPos, InnerProduct, Sym, x

from ..contracts import Array
from ..exceptions import ProblemError
from .materials import AnisotropicMaterial, HookeMaterial

TURN = 2 * np.pi
AXIS = 1e-12        # radius below which a point lies on the axis, relative to the largest one
NEAR = 1e-6         # the same where a point is one to look at, and u_r(0)/r would be seen: corners of elements are farther
SECTION = 0, 1, 5   # rows and columns of Voigt's matrix in the order r, z, theta that are those of the section


class Cartesian:
    """The mesh is the body.

    directions : of the derivatives in a strain, or None for as many as the mesh has dimensions
    bonus : quadrature degrees that integrals need beyond those of products of two functions
    axes : letters of the directions, t for theta
    rigid : which of the rigid motions of `mesh.facets.RigidMotions` cost no energy
    """

    revolved: ClassVar[bool] = False
    axes: ClassVar[str] = "xyz"
    bonus: ClassVar[int] = 0
    rigid: ClassVar[slice] = slice(None)

    def Spatial(self, strain: Any, u: Any) -> Any:
        """eps(u) from sym(grad u) and u."""
        return strain

    def Strain(self, u: Any) -> Any:
        """eps(u) of a trial or test function or a GridFunction, no unit."""
        return self.Spatial(Sym(Grad(u)), u)

    def OtherStrain(self, u: Any) -> Any:
        """eps(u) of the neighbour across a facet."""
        return self.Spatial(Sym(Grad(u).Other() if isinstance(u, GridFunction) else Grad(u.Other())), u.Other())

    def Plane(self, tensor: Any) -> Any:
        """The part of a tensor that acts in the plane of the mesh, shape (d, d)."""
        return tensor

    def InPlane(self, material: Any) -> Any:
        """The material that knows the strains and stresses in that plane alone."""
        return material

    def Elastic(self, material: Any, u: Any, v: Any, symbol: Any) -> Any:
        """The integral of C eps(u):eps(v)."""
        return self.Integral(InnerProduct(material.Stress(self.Strain(u)), self.Strain(v)), symbol)

    def Directions(self, dim: int) -> int:
        """Of strains and of C, on a mesh of this dimension."""
        return dim

    def Weighted(self, integrand: Any) -> Any:
        """What is to be integrated over the mesh, of an integrand over the body."""
        return integrand

    def Integral(self, integrand: Any, symbol: Any) -> Any:
        """The integral over the body, symbol dx or ds those of the mesh."""
        return self.Weighted(integrand) * symbol

    def Weights(self, weights: Array, coordinates: Array, trapezoidal: bool = False) -> Array:
        """Weights (n,) of a quadrature over the body, from those of one on boundary elements of the mesh at points (n, d).

        trapezoidal : True of the rule with the two ends of every element as points, one after the other
        """
        return weights

    def Refuse(self, name: str) -> None:
        """Raise ProblemError where something of this name does not know the frame."""


class Cylindrical(Cartesian):
    """The mesh is half of the section of a body of revolution, whose axis is x = 0."""

    revolved: ClassVar[bool] = True
    axes: ClassVar[str] = "rzt"
    # For r, and for u_r v_r/r: more change no error; and that of loads, which matters on curved sides.
    bonus: ClassVar[int] = 2
    rigid: ClassVar[slice] = slice(1, 2)        # along the axis

    def Spatial(self, strain: Any, u: Any) -> Any:
        hoop = u[0] / x
        if isinstance(u, GridFunction):     # pictures ask for values on the axis, where u_r/r is d_r u_r
            hoop = IfPos(x - NEAR * np.asarray(u.space.mesh.ngmesh.Coordinates())[:, 0].max(), hoop, strain[0, 0])
        return CF((strain[0, 0], strain[0, 1], 0, strain[1, 0], strain[1, 1], 0, 0, 0, hoop), dims=(3, 3))

    def Plane(self, tensor: Any) -> Any:
        return CF((tensor[0, 0], tensor[0, 1], tensor[1, 0], tensor[1, 1]), dims=(2, 2))

    def InPlane(self, material: Any) -> Any:
        if isinstance(material, HookeMaterial):
            return material
        return AnisotropicMaterial([[material.voigt[i][j] for j in SECTION] for i in SECTION])

    def Around(self, material: Any) -> tuple[Any, Any]:
        """(C_ijtt (2, 2), C_tttt), what a hoop strain 1 gives, in the plane and around [stress]."""
        if isinstance(material, HookeMaterial):
            return material.lam * Id(2), material.lam + 2 * material.mu
        rr, zz, hoop, _, _, rz = (row[2] for row in material.voigt)
        return CF((rr, rz, rz, zz), dims=(2, 2)), hoop

    def Elastic(self, material: Any, u: Any, v: Any, symbol: Any) -> Any:
        # Term by term: NGSolve takes six times as long for products of matrices (3, 3).
        (tie, hoop), inside = self.Around(material), self.InPlane(material).Stress(Sym(Grad(u)))
        ring = self.Integral(InnerProduct(inside, Sym(Grad(v))), symbol) + TURN * hoop / x * u[0] * v[0] * symbol
        return ring + TURN * (InnerProduct(tie, Grad(u)) * v[0] + u[0] * InnerProduct(tie, Grad(v))) * symbol

    def Directions(self, dim: int) -> int:
        return 3

    def Weighted(self, integrand: Any) -> Any:
        return TURN * x * integrand

    def Weights(self, weights: Array, coordinates: Array, trapezoidal: bool = False) -> Array:
        r = np.where(coordinates[:, 0] > AXIS * coordinates[:, 0].max(initial=0), coordinates[:, 0], 0)
        if trapezoidal:     # that of hat functions: the integrals of these with r are its weights
            ends = r.reshape(-1, 2)
            r = ((2 * ends + ends[:, ::-1]) / 3).ravel()
        return TURN * r * weights

    def Refuse(self, name: str) -> None:
        raise ProblemError(f"{name} is for bodies that are the mesh itself, and this one is of revolution, with the weight "
                           "2 pi r in its integrals; compare with a finer mesh, or take the body in space")


CARTESIAN, CYLINDRICAL = Cartesian(), Cylindrical()
