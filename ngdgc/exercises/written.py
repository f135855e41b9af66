"""All exercises with their answers, from the module of each notebook; a package of students has a sealed file instead."""

from __future__ import annotations

from typing import Any

from . import estimates, fluxes, iteration, law, liftings, locking, mindlin, newton, rigid, spaces, table, winkler

EXERCISES: dict[str, Any] = {name: exercise for module in (winkler, spaces, fluxes, liftings, iteration, newton, table, rigid,
                                                           locking, law, estimates, mindlin)
                             for name, exercise in module.EXERCISES.items()}
