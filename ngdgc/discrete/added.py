"""Forms of the user's own that are added to a problem: springs, a convection, a load."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from ngsolve import BilinearForm, FESpace, LinearForm, Norm

from ..exceptions import ProblemError
from ..mesh.checks import CheckSkeleton
from ..mesh.facets import Csr, Facets, Threads

SPELLING = "write dx, dx(skeleton=True) between elements of a discontinuous method, or ds(skeleton=True, definedon=...)"
# How NGSolve prints the integrators of these: over elements, and over facets.
INTEGRATORS = "Symbolic BFI", "Symbolic LFI", "Integrator"
ROUNDOFF = 1e-9     # of two ways to apply a form, relative


class AddedForms:
    """BilinearForms and LinearForms on a space, frozen as they were when they were added; what they hold may be changed later.

    Attributes
    ----------
    matrix : the sum of the bilinear forms, scipy CSR (ndof, ndof), or None;  load : that of the linear ones (ndof,), or None
    """

    def __init__(self, space: FESpace, facets: Facets, forms: Sequence[BilinearForm | LinearForm] = (),
                 parts: Sequence[Any] = ()) -> None:
        self.space, self.facets, self._forms, self._parts = space, facets, list(forms), list(parts)
        self.matrix, self.load = self._Sum(BilinearForm), self._Sum(LinearForm)

    def __bool__(self) -> bool:
        return bool(self._forms)

    def And(self, form: Any) -> AddedForms:
        """AddedForms with one form more, checked and assembled; ProblemError for one that is not of the listed kind."""
        self._CheckForm(form)
        self._CheckIntegrals(form)
        part = self._Assembled(form)
        if isinstance(form, BilinearForm):
            self._CheckBilinear(form)
        values = part.data if isinstance(form, BilinearForm) else part
        if not np.all(np.isfinite(values)):
            raise ProblemError("the added form is not finite; look for a division by zero or a root of a negative number")
        if not len(form.integrators) and not np.any(values):
            raise ProblemError("the form has no integrals; give it some, with +=, before it is added")
        return AddedForms(self.space, self.facets, [*self._forms, form], [*self._parts, part])

    def Current(self) -> AddedForms:
        """The same forms with the values that Parameters in them have now: this object if they are what they were."""
        parts = [self._Assembled(form) for form in self._forms]
        same = all(np.array_equal(getattr(new, "data", new), getattr(old, "data", old)) for new, old in zip(parts, self._parts))
        return self if same else AddedForms(self.space, self.facets, self._forms, parts)

    def SameMatrix(self, other: AddedForms) -> bool:
        """True if the matrix is that of other added forms, whatever the load is."""
        a, b = self.matrix, other.matrix
        return a is b or a is not None and b is not None and a.shape == b.shape and (a != b).nnz == 0

    def _Sum(self, kind: type) -> Any:
        parts = [part for form, part in zip(self._forms, self._parts) if isinstance(form, kind)]
        return sum(parts[1:], parts[0]) if parts else None

    def _CheckForm(self, form: Any) -> None:
        """Of the right type and space, before anything is assembled."""
        if not isinstance(form, (BilinearForm, LinearForm)):
            raise ProblemError(f"form is {form!r}; give an NGSolve BilinearForm or LinearForm on disc.space")
        if form.space is not self.space:
            raise ProblemError("form lives on another space; make it on disc.space")
        unfit = {"condense", "nonassemble", "diagonal", "geom_free"} & set(str(form.flags).split())
        if unfit or getattr(form, "testspace", self.space) is not self.space:
            raise ProblemError("form is no sparse square matrix; make it BilinearForm(disc.space), without condense, "
                               "nonassemble, diagonal, geom_free or another test space")

    def _CheckIntegrals(self, form: BilinearForm | LinearForm) -> None:
        """Every integral is over elements or facets, and is not 0, as integrals over boundary elements are on these spaces."""
        for number, integrator in enumerate(form.integrators, start=1):
            kind, alone = str(integrator).strip(), type(form)(self.space)
            if kind not in INTEGRATORS:
                raise ProblemError(f"integral {number} of the form is {kind!r}, none of those that can be added; {SPELLING}")
            if kind == "Integrator":
                CheckSkeleton(self.facets)
            alone += integrator
            part = self._Assembled(alone)
            if not np.any(getattr(part, "data", part)):
                raise ProblemError(f"integral {number} of the form is 0: ds alone has no values of a discontinuous function, a "
                                   f"region may be empty, a Parameter 0; {SPELLING}, and add it while Parameters are not 0")

    def _Assembled(self, form: BilinearForm | LinearForm) -> Any:
        """The values of a form, scipy CSR or (ndof,), in memory of their own."""
        try:
            with Threads(self.space.mesh):
                form.Assemble()
        except Exception as error:      # NGSolve's have no common class but this
            raise ProblemError(f"form cannot be assembled: {str(error).strip().splitlines()[0]}; {SPELLING}") from error
        return Csr(form.mat) if isinstance(form, BilinearForm) else form.vec.FV().NumPy().copy()

    def _CheckBilinear(self, form: BilinearForm | LinearForm) -> None:
        """The form is linear in the trial function, and its matrix is what it applies."""
        vector, once, twice, product = (form.mat.CreateColVector() for _ in range(4))
        vector.FV().NumPy()[:] = np.random.default_rng(1).standard_normal(self.space.ndof)
        with Threads(self.space.mesh):
            product.data = form.mat * vector
            form.Apply(vector, once)
            vector.data = 2 * vector
            form.Apply(vector, twice)
        if Norm(twice - 2 * once) > ROUNDOFF * Norm(twice):
            raise ProblemError("form is not linear in the trial function; only bilinear forms can be added")
        if Norm(once - product) > ROUNDOFF * max(Norm(once), Norm(product)):
            raise ProblemError("form has another matrix than it applies, as forms have with Other() on the boundary or with "
                               f"element_boundary; leave Other() out there, {SPELLING}")
