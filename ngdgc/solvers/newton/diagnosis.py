"""Why a run of Newton's method has failed, and what to do about it."""

from __future__ import annotations

import numpy as np

from .record import SMALL, Record
from .setting import Setting


def Diagnose(reason: str, record: Record, setting: Setting, *, tol: float, reached: float | None) -> tuple[str, None]:
    """(cause and remedy of a failure, None).

    reason : of the driver;  record : `Record` of the run;  reached : part of the load up to which it was raised, or None
    """
    if reason == "slow":
        return "Newton reached its limit of steps while still making progress; raise maxiter", None
    if record.residual < SMALL:
        return f"tol={tol:g} is below what round-off allows here; take a larger tol", None
    what = _Course(record)
    if reached is not None:
        what += f", and raising the load in steps was given up at {reached:.0%} of it"
    if setting.disc.unresisted:
        return (f"{what}.  The foundation alone resists {setting.disc.unresisted}: there is no equilibrium if the loads pull "
                "the body off or push it along harder than friction holds.  Remedy: other loads, dirichlet or roller"), None
    return (f"{what}.  With strong friction that grows with the pressure, or a law that is not monotone, there may be "
            "several solutions or none nearby.  Remedy: a smaller friction coefficient, other starts (MultiStart), or a "
            "finer mesh at the ends of the zones"), None


def _Course(record: Record) -> str:
    """Words for what the steps did."""
    period = record.Period()
    if not period:
        return f"Newton stagnates, its last step shortened to {record.steps[-1].length if record.steps else 1:.2g}"
    zones = [step.zones for step in record.taken[-period:]]
    changing = int(np.sum(np.any(np.array(zones) != zones[-1], axis=0)))
    return f"Newton cycles with period {period} between states that differ in the zones of {changing} points"
