"""The report and its numbers say how wrong a solution is, once that was estimated."""

import pytest

from ngdgc import LDG, EstimateError, EstimateForce, EstimateZones
from ngdgc.cases import example_4_2


def test_report_says_how_wrong_it_is():
    solution = example_4_2.Main(n=4, method=LDG())
    assert "Estimated error" not in solution.Report() and solution.ToJSON()["estimated_error"] is None
    solution.estimate = EstimateError(solution)
    text, numbers = solution.Report(), solution.ToJSON()["estimated_error"]
    assert f"{100 * solution.estimate.relative:.2g} % of the solution" in text
    assert numbers["value"] == solution.estimate.value
    assert sum(part ** 2 for part in numbers["parts"].values()) == pytest.approx(numbers["value"] ** 2)


def test_zones_and_forces_of_the_report_have_their_errors():
    solution = example_4_2.Main(n=4, method=LDG())
    assert "+-" not in solution.Report() and solution.ToJSON()["zone_errors"] is None
    solution.zoneerrors, solution.forceerrors = EstimateZones(solution), EstimateForce(solution)
    text, numbers = solution.Report(), solution.ToJSON()
    assert f"slip {solution.ZoneLengths()['slip']:.4g} +- {solution.zoneerrors['slip']:.2g} (" in text
    assert numbers["zone_errors"] == solution.zoneerrors
    assert "Estimated error of the force bottom: " in text
    assert numbers["estimated_quantities"]["force bottom"]["error"] == solution.forceerrors.error["bottom"].tolist()
