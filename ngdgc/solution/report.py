"""A solution as a page of text and as a dictionary of plain numbers."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from ..contracts import Array
from ..problem.problem import ContactProblem
from ..tools.formula import Formula
from ..tools.units import InUnits

LINE = 78
# What `ContactSolution.ToJSON` holds; ranges are {"smallest": , "largest": } over the contact points.
SCHEMA = {
    "ngdgc": "version", "ngsolve": "version", "case": "name of the case that was run, or null",
    "method": "name", "options": "the method as it is written in Python", "material": "as written", "foundations": "as written",
    "dirichlet": "of each region, as written", "roller": "the same", "traction": "the same", "force": "the same",
    "spring": "the same", "bodyforce": "as written, or null",
    "units": "of length and stress, or null",
    "order": "polynomial degree", "dimension": "2 or 3",
    "axisymmetric": "true for a body of revolution: forces, areas and energy are those of the whole ring",
    "elements": "number", "dofs": "number of unknowns",
    "contact_points": "number",
    "solver": "as written", "inverse": "what solved the linear equations", "converged": "true or false",
    "iterations": "number, on the last mesh", "change": "of u, last iteration [1], or null without iteration",
    "law_residual": "largest distance to the contact law [1], or null", "solves": "linear solves, or null",
    "seconds": "of the iteration [s], or null",
    "contraction": "factors per iteration, predicted and observed [1], each or null",
    "levels": "of nested or adaptive meshes: elements, dofs, points, iterations, solves, factorisation [s], seconds [s], "
              "converged, and estimated relative error [1] or null, of each",
    "elastic_energy": "[stress length^d]", "normal_force": "int p_n [stress length^(d-1)]",
    "zones": "length or area of separation, stick and slip [length^(d-1)]",
    "zone_errors": "estimated errors of these, or null",
    "estimated_error": "in the energy norm: value [sqrt(stress length^d)], relative to the solution [1], parts [as the value]; "
                       "or null",
    "estimated_quantities": "of an adaptive run, forces or other goals: value and signed error of each quantity; or null",
    "penetration": "range of u_n - g [length]", "pressure": "range of p_n [stress]", "friction": "range of |sigma_t| [stress]",
    "slip": "range of |u_t| [length]",
    "resultants": "of supports, loads and foundations, of joints on their first sides: kind, region, force (d) "
                  "[stress length^(d-1)], moment about the origin [stress length^d], and integrated_stress (force, moment) by "
                  "sigma n or null",
    "punches": "of each foundation that is a rigid punch: displacement [length] and rotation [1]",
    "equilibrium_residual": "|A u - f + T' W t| relative to its terms [1]",
    "global_imbalance": "sum of forces and moments, relative",
    "element_imbalance": "the largest of an element, relative; discontinuous methods only",
}


def JsonValue(value: Any) -> Any:
    """The value in types that JSON has: numbers that are not finite, which it has not, become None."""
    if isinstance(value, dict):
        return {key: JsonValue(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [JsonValue(entry) for entry in value]
    if isinstance(value, np.generic):
        value = value.item()
    return None if isinstance(value, float) and not np.isfinite(value) else value


def Summary(solution: Any) -> dict[str, Any]:
    """The numbers of the report, as the `SCHEMA` says."""
    from importlib.metadata import version      # slow to import

    disc = solution.disc
    last = solution.history[-1] if solution.history else None
    slip = np.linalg.norm(solution.slip, axis=1)
    summary = {
        "ngdgc": version("ngdgc"), "ngsolve": version("ngsolve"),
        "case": solution.case,
        "material": repr(disc.problem.material), "foundations": [repr(foundation) for foundation in disc.problem.foundation],
        **_Data(disc.problem), "units": disc.problem.units,
        "method": disc.method.name, "options": repr(disc.method), "order": disc.order, "dimension": disc.mesh.dim,
        "axisymmetric": disc.problem.axisymmetric,
        "elements": disc.mesh.ne, "dofs": disc.unknowns, "contact_points": len(solution.weights),
        "solver": solution.solver, "inverse": solution.inverse, "converged": solution.converged,
        "iterations": len(solution.history),
        "change": last.change if last else None, "law_residual": last.residual if last else None,
        "solves": last.solves if last else None, "seconds": last.seconds if last else None,
        "contraction": asdict(solution.rates), "levels": [asdict(level) for level in solution.levels],
        "elastic_energy": solution.energy, "normal_force": solution.normalforce,
        "zones": solution.ZoneLengths(), "zone_errors": solution.zoneerrors,
        "estimated_error": _Estimated(solution.estimate), "estimated_quantities": _Quantities(solution),
        "penetration": _Range(solution.penetration), "pressure": _Range(solution.pressure),
        "friction": _Range(np.linalg.norm(solution.friction, axis=1)), "slip": _Range(slip),
        "resultants": [
            {"kind": resultant.kind, "region": resultant.region, "force": resultant.force.tolist(),
             "moment": resultant.moment.tolist(),
             "integrated_stress": resultant.integrated and [part.tolist() for part in resultant.integrated]}
            for resultant in solution.Resultants()],
        "punches": {region: {"displacement": motion[:disc.mesh.dim].tolist(), "rotation": motion[disc.mesh.dim:].tolist()}
                    for region, motion in solution.punches.items()},
        "equilibrium_residual": solution.EquilibriumResidual(),
        "global_imbalance": solution.GlobalImbalance(),
    }
    if disc.method.conservative:
        summary["element_imbalance"] = solution.worst
    return summary


def _Estimated(estimate: Any) -> dict[str, Any] | None:
    """Of an `ErrorEstimate`."""
    if not hasattr(estimate, "parts"):
        return None
    return {"value": estimate.value, "relative": estimate.relative, "parts": dict(estimate.parts)}


def _Quantities(solution: Any) -> dict[str, Any] | None:
    """Of a `ForceEstimate`, that of an adaptive run for its goal, or that of the forces."""
    estimate = solution.estimate if hasattr(solution.estimate, "corrected") else solution.forceerrors
    if estimate is None:
        return None
    return {f"force {key}" if isinstance(key, str) else f"{key[0]} {key[1]}":
            {"value": value.tolist(), "error": estimate.error[key].tolist()} for key, value in estimate.value.items()}


def _Data(problem: ContactProblem) -> dict[str, Any]:
    """Supports and loads as they are written, those too of which there are none."""
    data = {name: {region: Formula(value) for region, value in getattr(problem, name).items()}
            for name in ("dirichlet", "roller", "traction", "force", "spring")}
    return {**data, "bodyforce": problem.bodyforce and Formula(problem.bodyforce)}


def _Range(values: Array) -> dict[str, float]:
    return {"smallest": float(np.min(values)), "largest": float(np.max(values))}


def Report(solution: Any) -> str:
    """A page of text, with units where the problem has them."""
    numbers = Summary(solution)
    text = "\n".join([_Head(numbers), "", *_Iteration(numbers), "", *_Contact(numbers), "", *_Forces(numbers), ""])
    return InUnits(text, solution.disc.problem.units, bare=True)


def _Head(numbers: dict[str, Any]) -> str:
    title = f"{numbers['options']}, order {numbers['order']}, {numbers['dimension']}D"
    size = f"{numbers['elements']} elements, {numbers['dofs']} unknowns, {numbers['contact_points']} contact points"
    return f"{title}\n{size}\n{'=' * LINE}"


def _Iteration(numbers: dict[str, Any]) -> list[str]:
    if numbers["change"] is None:
        return [numbers["solver"] or "no iteration recorded"]
    state = "converged" if numbers["converged"] else "NOT CONVERGED: the numbers below are those of the last iterate"
    return [numbers["solver"],
            f"  {state}, {numbers['iterations']} iterations, {numbers['solves']} linear solves by {numbers['inverse']}, "
            f"{numbers['seconds']:.2f} s",
            f"  last change {numbers['change']:.1e}, distance to the contact law {numbers['law_residual']:.1e}",
            *_Rates(numbers["contraction"]), *_Levels(numbers["levels"])]


def _Rates(rates: dict[str, Any]) -> list[str]:
    found = [f"{name} {rates[name]:.4g}" for name in ("predicted", "observed") if rates[name] is not None]
    return [f"  contraction per iteration: {', '.join(found)}"] if found else []


def _Levels(levels: list[dict[str, Any]]) -> list[str]:
    lines = []
    for number, level in enumerate(levels, start=1):
        state = "" if level["converged"] else ", not converged"
        error = "" if level["error"] is None else f", estimated error {level['error']:.2g}"
        lines.append(f"  mesh {number}: {level['dofs']} unknowns, {level['points']} contact points, {level['iterations']} "
                     f"iterations, {level['solves']} linear solves, {level['seconds']:.2f} s ({level['factorisation']:.2f} s "
                     f"factorising){state}{error}")
    return lines


def _Contact(numbers: dict[str, Any]) -> list[str]:
    dim = _Space(numbers)
    length = "length" if dim == 2 else "area"
    total = sum(numbers["zones"].values())
    errors = numbers["zone_errors"] or {}
    doubts = {name: f" +- {error:.2g}" if error else "" for name, error in errors.items()}
    zones = ",  ".join(f"{name} {size:.4g}{doubts.get(name, '')} ({100 * size / total:.0f} %)"
                       for name, size in numbers["zones"].items())
    rows = [("penetration u_n - g", "penetration", "length"), ("pressure p_n", "pressure", "stress"),
            ("friction |sigma_t|", "friction", "stress"), ("slip |u_t|", "slip", "length")]
    return [f"Contact boundary: {length} {total:.4g} [length{'^2' if dim == 3 else ''}]", f"  {zones}",
            *(f"  {label:<22}{numbers[key]['smallest']:>14.6g}  to {numbers[key]['largest']:>14.6g} [{unit}]"
              for label, key, unit in rows),
            f"  {'int p_n':<22}{numbers['normal_force']:>14.6g} {_Product(dim - 1)}",
            *_Punches(numbers["punches"]),
            f"Elastic energy {numbers['elastic_energy']:.6g} {_Product(dim)}", *_Error(numbers["estimated_error"]),
            *(f"Estimated error of the {name}: {', '.join(f'{error:+.2g}' for error in found['error'])}"
              for name, found in (numbers["estimated_quantities"] or {}).items())]


def _Punches(punches: dict[str, Any]) -> list[str]:
    return [f"Punch {region}: moved by ({', '.join(f'{entry:.6g}' for entry in motion['displacement'])}) [length], turned by "
            f"{', '.join(f'{entry:.6g}' for entry in motion['rotation'])}" for region, motion in punches.items()]


def _Space(numbers: dict[str, Any]) -> int:
    """The dimension of the body, which is that of the mesh, or of the body of revolution that the mesh is half a section of."""
    return numbers["dimension"] + numbers["axisymmetric"]


def _Product(power: int) -> str:
    """The unit of a force (d - 1), of a moment and an energy (d)."""
    return "[stress length]" if power == 1 else f"[stress length^{power}]"


def _Error(estimated: dict[str, Any] | None) -> list[str]:
    if not estimated:
        return []
    largest = max(estimated["parts"], key=estimated["parts"].get)
    return [f"Estimated error {estimated['value']:.3g} in the energy norm, {100 * estimated['relative']:.2g} % of the "
            f"solution, most of it in {largest!r}"]


def _Forces(numbers: dict[str, Any]) -> list[str]:
    dim, whole = _Space(numbers), numbers["axisymmetric"]
    axes = "rz" if whole else "xyz"[:dim]
    columns = [f"F_{axis}" for axis in axes] + ([] if whole else ["moment"] if dim == 2 else [f"M_{axis}" for axis in axes])
    rows = [f"Forces on the whole ring {_Product(dim - 1)}, F_r the integral of the radial traction" if whole else
            f"Forces on the body {_Product(dim - 1)} and moments about the origin {_Product(dim)}",
            " " * 26 + "".join(f"{column:>13}" for column in columns)]
    total = np.zeros(len(columns))
    inner = []      # on the first sides of joints, the second sides of which balance them
    for resultant in numbers["resultants"]:
        modes = np.array((resultant["force"] + resultant["moment"])[:len(columns)])
        row = _Row(f"{resultant['kind']} {resultant['region'] or ''}", modes)
        if resultant["kind"] == "joint":
            inner.append(row)
            continue
        total += modes
        rows.append(row)
        if resultant["integrated_stress"]:
            rows.append(_Row("  integrated sigma n", np.concatenate(resultant["integrated_stress"])[:len(columns)]))
    # Radial tractions that point to all sides have no sum.
    rows += [_Row("sum", [None, *total[1:]] if whole else total), *inner]
    balance = f"Balance: whole body {numbers['global_imbalance']:.1e}, equations {numbers['equilibrium_residual']:.1e}"
    if "element_imbalance" in numbers:
        balance += f", worst element {numbers['element_imbalance']:.1e} (relative)"
    return [*rows, balance]


def _Row(label: str, modes: Any) -> str:
    return f"  {label:<24}" + "".join(f"{'-':>13}" if mode is None else f"{mode:>13.5g}" for mode in modes)
