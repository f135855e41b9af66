"""Regions of a mesh, which are given as regular expressions over the names of boundaries or materials."""

from __future__ import annotations

import re
from typing import Any, cast

import numpy as np
from ngsolve import Mesh

from ..exceptions import ProblemError


def RegionName(region: Any, name: str) -> str:
    """A string that is a regular expression, else ProblemError."""
    try:
        re.compile(cast(str, region if isinstance(region, str) else None))
    except (TypeError, re.error, RecursionError, OverflowError) as error:
        raise ProblemError(f"{name} region is {region!r}; give a name or a regular expression such as 'left|right' "
                           f"({error})") from None
    return str(region)


def Matching(mesh: Mesh, region: str, name: str, *, kind: str = "boundary", there: slice | np.ndarray = slice(None),
             note: str = "") -> np.ndarray:
    """True for what a region matches, over the numbers of boundaries or materials (`kind`); ProblemError if that is nothing.

    there : numbers of what is part of the body;  note : what it would mean, behind the words that nothing matches
    """
    select, names = ((mesh.Boundaries, mesh.GetBoundaries()) if kind == "boundary" else (mesh.Materials, mesh.GetMaterials()))
    RegionName(region, name)
    try:
        mask = np.array(list(select(region).Mask()), dtype=bool)
    except Exception as error:
        raise ProblemError(f"{name} region is {region!r}, which NGSolve does not take for a regular expression "
                           f"({str(error).strip()}); give a name or alternatives such as 'left|right'") from error
    if region in names and not mask[names.index(region)]:
        raise ProblemError(f"{name} region {region!r} is the name of a {kind}, and does not match it: some of its letters mean "
                           f"something else in regular expressions; give {re.escape(region)!r}, as re.escape makes it")
    if not mask[there].any():
        raise ProblemError(f"{name} region {region!r} matches no {kind} of the mesh{note}; "
                           f"choose among {', '.join(sorted(set(np.array(names)[there])))}")
    return mask
