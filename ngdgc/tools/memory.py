"""Memory: how much this process may still take, and a refusal before something is begun that would take more."""

from __future__ import annotations

from collections.abc import Iterator
from math import comb, inf
from pathlib import Path

import psutil

from .failures import ProblemError

try:
    import resource
except ImportError:     # not on Windows, which has no such limits
    resource = None     # type: ignore[assignment]

GIGABYTE = 1e9
# Bytes, all measured on structured meshes and rather too small than too large: what is refused would not have ended well.
CELL = 350          # of a mesh, for each element
ENTRY = 13          # of a matrix while it is assembled, for each entry
TRIFLE = 1e7        # bytes about which limits of the process need not be asked
SMALL = 1e8         # bytes of meshes and matrices about which nobody needs to be asked
UNLIMITED = 1 << 60
CONTROL = Path("/sys/fs/cgroup"), Path("/proc/self/cgroup")
# (limit, use) of a control group in its first and in its second version.
GROUPS = ("memory.limit_in_bytes", "memory.usage_in_bytes"), ("memory.max", "memory.current")


def FreeMemory(sharing: int = 1) -> float:
    """Bytes that this process may still take: what is free, and what limits of the process and of its control groups leave.

    sharing : processes of this machine that will take as much

    >>> FreeMemory() > 0
    True
    """
    ofall = [psutil.virtual_memory().available, *_OfGroups(*CONTROL)]
    return max(0.0, min([min(ofall) / sharing, *_OfProcess()]))


def _OfProcess() -> Iterator[float]:
    """What `ulimit -v` and `ulimit -d` leave."""
    if resource is not None:
        used = psutil.Process().memory_info()
        for limit, size in ((resource.RLIMIT_AS, used.vms), (resource.RLIMIT_DATA, getattr(used, "data", used.rss))):
            soft, _ = resource.getrlimit(limit)
            if soft != resource.RLIM_INFINITY:
                yield soft - size


def _OfGroups(root: Path, listing: Path) -> Iterator[float]:
    """What the control groups of the process and those above leave, as containers and batch systems set them."""
    try:
        lines = listing.read_text(encoding="utf-8").splitlines()
    except OSError:
        return
    for line in lines:
        _, controllers, name = line.split(":", 2)
        top = root / controllers if controllers else root
        # In a container the name is that of the host, and only the group at the top is to be seen.
        for folder in {top / part.relative_to("/") for part in (Path(name), *Path(name).parents)}:
            for limit, use in GROUPS:
                if (folder / limit).is_file() and (folder / use).is_file():
                    yield _Number(folder / limit) - _Number(folder / use) + _Reclaimable(folder / "memory.stat")


def _Number(path: Path) -> float:
    text = path.read_text(encoding="utf-8").strip()
    return inf if text == "max" or int(text) > UNLIMITED else int(text)


def _Reclaimable(path: Path) -> float:
    """Of a control group's use what is a copy of files, which the system drops when memory is needed."""
    lines = path.read_text(encoding="utf-8").splitlines() if path.is_file() else []
    return sum(int(line.split()[1]) for line in lines if line.startswith("inactive_file "))


def CheckMemory(needed: float, what: str, remedy: str, sharing: int = 1) -> None:
    """Raise ProblemError if something needs more bytes than are free; sharing : as for `FreeMemory`."""
    # Limits are in files, which take longer to read than a small matrix to factorise.
    free = FreeMemory(sharing) if needed > TRIFLE else psutil.virtual_memory().available
    if needed > free:
        raise ProblemError(f"{what} would take about {needed / GIGABYTE:.3g} GB, and {free / GIGABYTE:.1f} GB are free; "
                           f"take {remedy}a coarser mesh or a lower order")


def CheckCells(elements: float) -> None:
    """Raise ProblemError for a mesh of so many elements that it would not fit."""
    _CheckLarge(CELL * elements, f"a mesh of {elements:.3g} elements")


def CheckAssembly(elements: int, dim: int, order: int, *, discontinuous: bool) -> None:
    """Raise ProblemError for a matrix that would not fit while it is assembled."""
    _CheckLarge(AssemblyBytes(elements, dim, order, discontinuous=discontinuous),
                f"the matrix of {elements} elements of order {order}")


def AssemblyBytes(elements: float, dim: int, order: int, *, discontinuous: bool) -> float:
    """Bytes of a matrix while it is assembled.

    Counted as on simplices, which have the fewest unknowns: each of a discontinuous method's couples to those of its own
    element and of dim + 1 neighbours, each of a continuous one's at least to those of its own.
    """
    own = dim * comb(order + dim, dim)
    return ENTRY * (elements * own * own * (dim + 2) if discontinuous else elements * dim * order ** dim / 2 * own)


def _CheckLarge(needed: float, what: str) -> None:
    if needed > SMALL:
        CheckMemory(needed, what, "")
