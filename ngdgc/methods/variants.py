"""The nine discretisations to compare: the paper's four discontinuous methods in two forms each, and H1."""

from __future__ import annotations

from typing import Any

from ..exceptions import ProblemError
from ..tools.calls import ByKeyword
from ..tools.names import Meant
from ..tools.values import Among
from .registry import METHODS, PAPER, Options

FORMS = ("edge", "lifting")


@ByKeyword
def Label(method: Any) -> str:
    """Name and form, as tables and legends print them.

    >>> from ngdgc import LDG
    >>> Label(LDG(form="lifting"))
    'LDG lifting'
    """
    return f"{method.name} {method.form}" if hasattr(method, "form") else method.name


@ByKeyword
def Variants(method: str = "all", *, form: str | None = None, penalty: Any = "auto") -> dict[str, Any]:
    """Methods by their names on the command line, {label: method}.

    method : one of `registry.METHODS`, such as "ip", or "all", those of the paper and "h1"
    form : "edge" or "lifting", by default both
    penalty : "auto", a number for every method that has one, or {name: penalty} with "auto" for those it does not name

    Raises ProblemError for an unknown method or form, and for form or penalty of a single method that has none.

    >>> list(Variants("ip"))
    ['IP edge', 'IP lifting']
    """
    if not Among(method, ("all", *METHODS)):
        raise ProblemError(f"no method {method!r}; choose all or one of {', '.join(METHODS)}{Meant(str(method), METHODS)}")
    if not Among(form, (*FORMS, None)):
        raise ProblemError(f"form is {form!r}; choose edge or lifting, or give none for both")
    options = set.union(*(Options(row) for row in METHODS.values())) if method == "all" else Options(METHODS[method])
    for name, value, default in (("form", form, None), ("penalty", penalty, "auto")):
        if name not in options and not isinstance(value, dict) and not Among(value, (default,)):
            raise ProblemError(f"{name} does not apply to method {method!r}; leave it out")
    penalties = penalty if isinstance(penalty, dict) else dict.fromkeys(METHODS, penalty)
    chosen = []
    for name in PAPER if method == "all" else (method,):
        row, eta = METHODS[name], penalties.get(name, "auto")
        given = {"penalty": eta} if "penalty" in Options(row) and not Among(eta, ("auto",)) else {}
        chosen += ([row(form=one, **given) for one in FORMS if form in (one, None)] if "form" in Options(row)
                   else [row(**given)])
    return {Label(one): one for one in chosen}
