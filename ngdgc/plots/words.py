"""Words for values that are prescribed: what the pictures of a setting say beside a boundary."""

from __future__ import annotations

import numpy as np

from ..contracts import Array


def Span(symbol: str, values: Array) -> str:
    """Words for values (n,) or (n, d): the value if it is constant, else the range of its size."""
    values = np.where(np.abs(values) > 1e-9 * np.abs(values).max(), values, 0)
    if np.all(np.ptp(values, axis=0) <= 1e-9 * np.abs(values).max()):
        text = ", ".join(f"{value:.4g}" for value in np.atleast_1d(values[0]))
        return f"{symbol} = ({text})" if values.ndim == 2 else f"{symbol} = {text}"
    if values.ndim == 2:
        symbol, values = f"|{symbol}|", np.linalg.norm(values, axis=1)
        if np.ptp(values) <= 1e-9 * values.max():
            return f"{symbol} = {values[0]:.4g}"
    return f"{symbol} = {values.min():.4g} to {values.max():.4g}"


def Prescribed(kind: str, values: Array) -> str:
    """What acts on a boundary: the kind as `ContactProblem.Regions` has it, and its values there."""
    if kind == "dirichlet":
        return f"prescribed\n{Span('u', values)}" if np.any(values) else "clamped"
    if kind == "roller":
        return f"roller\n{Span('$u_n$', values)}" if np.any(values) else "roller"
    if kind == "spring":
        return f"springs\n{Span('k', values)}"
    if kind == "force":
        return f"force\n{Span('F', values)}"
    return f"traction\n{Span('$f_2$', values)}" if kind == "traction" else f"{kind}\n{Span('g', values)}"
