"""The report and its numbers say how wrong a solution is, once that was estimated."""

import pytest

from ngdgc import LDG, EstimateError
from ngdgc.cases import example_4_2


def test_report_says_how_wrong_it_is():
    solution = example_4_2.Main(n=4, method=LDG())
    assert "Estimated error" not in solution.Report() and solution.ToJSON()["estimated_error"] is None
    solution.estimate = EstimateError(solution)
    text, numbers = solution.Report(), solution.ToJSON()["estimated_error"]
    assert f"{100 * solution.estimate.relative:.2g} % of the solution" in text
    assert numbers["value"] == solution.estimate.value
    assert sum(part ** 2 for part in numbers["parts"].values()) == pytest.approx(numbers["value"] ** 2)
