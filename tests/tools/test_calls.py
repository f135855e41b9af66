"""Calls of public names: arguments that do not fit are named, and what is right is what it was."""

import importlib
import inspect
import re
from pathlib import Path

import pytest
from mistakes import Disc

import ngdgc
from ngdgc import HookeMaterial, NormalCompliance, ProblemError
from ngdgc.tools.calls import ByKeyword
from ngdgc.problem.laws import ComplianceLaw

API = (Path(__file__).parents[2] / "docs" / "api.md").read_text(encoding="utf-8")


def Documented():
    """(name, object) of every class and function that docs/api.md names, but NGSolve's own and an exception of one message."""
    for module, *names in (line.split() for line in re.findall(r"^% public: (.*)$", API, re.M)):
        module = importlib.import_module(module)
        for name in names or [name for name, value in vars(module).items() if not name.startswith("_") and callable(value)
                              and getattr(value, "__module__", "").startswith(module.__name__)]:
            if getattr(module, name) not in (ngdgc.Solve, ProblemError):
                yield f"{module.__name__}.{name}", getattr(module, name)


def Told(thing):
    """Does a class, or a function, tell which argument is wrong?"""
    if inspect.isclass(thing):
        return Told(thing.__init__)
    return hasattr(thing, "__wrapped__")


def test_every_documented_name_tells_which_argument_is_wrong():
    names = dict(Documented())
    assert len(names) > 90 and set(ngdgc.__all__) - {"Solve", "ProblemError"} <= {name.rpartition(".")[2] for name in names}
    assert [name for name, thing in names.items() if not Told(thing)] == []
    assert not Told(Documented)         # control: this function does not
    for name, thing in names.items():
        for method, member in vars(thing).items() if inspect.isclass(thing) else ():
            if inspect.isfunction(member) and not method.startswith("_") and member.__module__.startswith("ngdgc"):
                assert Told(member), f"{name}.{method}"


@pytest.mark.parametrize("name, thing", list(Documented()))
def test_a_keyword_that_nobody_has_is_a_problem(name, thing):
    with pytest.raises(ProblemError, match="there is no argument 'nobody'"):
        thing(nobody=3)


def test_errors_inside_a_function_stay_what_they_are():
    @ByKeyword
    def Divide(a, *, by):
        return a / by

    assert Divide(6, by=3) == 2
    with pytest.raises(TypeError, match="unsupported operand"):
        Divide("6", by=3)
    with pytest.raises(ProblemError, match=re.escape("Divide(...): 3 by position; give it by name: by=3")):
        Divide(6, 3)


def test_what_is_right_is_as_before():
    """Signatures and texts are those of the class; laws of users inherit."""
    assert list(inspect.signature(HookeMaterial).parameters) == ["E", "nu", "mu", "lam", "plane"]
    assert repr(NormalCompliance(2)) == "NormalCompliance(stiffness=2.0, exponent=1)"
    assert inspect.signature(Disc().Solve).parameters["tol"].default == 1e-10

    class Law(ComplianceLaw):
        def __init__(self, k):
            self.k = k

    assert Law(k=3).k == 3
    with pytest.raises(TypeError):      # a user's own constructor is the user's
        Law(stiffness=3)
