"""Mistakes with forces through regions, as in `mistakes`."""

from bodies import LINE, RING, Crossed, Layers
from mistakes import Disc

from ngdgc import InteriorPenalty, Solve


class Unbalanced(InteriorPenalty):
    """Says of itself that its flux balances nothing."""

    conservative = False


FORCES = [
    (lambda _: Solve(Disc(Unbalanced())).Force("top"), "method IP has no numerical flux | its forces are not known | take one"),
    (lambda _: Solve(Disc()).Force("buttom"),
     "boundary region 'buttom' matches no boundary | bottom, left, right, top | choose"),
    (lambda _: Solve(Disc()).Mean("(?i)TOP"), "boundary region is '(?i)TOP' | a regular expression | give a name"),
    (lambda _: Solve(Disc()).Force("top", material="steel"), "material region 'steel' matches no material | dom | choose"),
    (lambda _: Solve(Disc(mesh=Layers(2))).Force(".*"),
     "region '.*' has facets on the boundary of the body and facets inside it | one kind | give"),
    (lambda _: Solve(Disc(mesh=Layers(2))).Force("top", material="soft"),
     "region 'top' is no boundary of material 'soft' | one that touches it | give"),
    (lambda _: Solve(Disc(mesh=Crossed({"ring": [RING]}))).Force("ring", material=".*"),
     "region 'ring' has material '.*' on both sides | without material= | give"),
    (lambda _: Solve(Disc(mesh=Crossed({"lines": [LINE, RING[:2]]}))).Force("lines"),
     "region 'lines' is an interface of several pieces | on which side | give material="),
    (lambda _: Solve(Disc()).At("a", 0), "point is ('a', 0) | its 2 coordinates | give")]
