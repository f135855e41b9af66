"""The command that looks at the estimates of errors: against exact solutions, and on random problems."""

from __future__ import annotations

from argparse import Namespace

from .arguments import Commands, Natural, Positive
from .files import Files
from .studies import Page, Show


def AddEffectivity(commands: Commands) -> None:
    """The parser of the command, added to those of the command line."""
    parser = commands.add_parser("effectivity", help="estimated errors over true ones", description="Estimate and bound of the "
                                 "error over the true error: on exact solutions and on random problems, and what adaptive "
                                 "meshes save.  What was computed is written also after Ctrl-C.")
    parser.add_argument("--count", type=Natural, default=20, help="number of random problems in 2D (default 20)")
    parser.add_argument("--solids", type=Natural, default=5, help="number of random problems in 3D (default 5)")
    parser.add_argument("--seed", type=Positive, default=1, help="seed of the random numbers (default 1)")
    parser.add_argument("--page", metavar="FILE", help="the documentation page to write (in a checkout docs/effectivity.md)")
    parser.add_argument("--out", default="results", help="folder for the tables (default results/)")
    parser.set_defaults(command=Effectivity)


def Effectivity(options: Namespace) -> int:
    """Estimate, compare, write."""
    from ..studies import effectivity as study
    from ..studies.savings import Saving, Savings

    exact: list[study.Estimated] = []
    random: list[study.Estimated] = []
    savings: list[Saving] = []
    with Files(options.out, "effectivity.txt") as files, Page(options.page) as page:
        try:
            for row in study.Exacts(callback=Show):
                exact.append(row)
            for dim, count in ((2, options.count), (3, options.solids)):
                for row in study.Randoms(options.seed, count, dim=dim, callback=Show):
                    random.append(row)
            for saving in Savings(callback=Show):
                savings.append(saving)
        finally:
            if exact:
                print(text := study.Text(exact, random, savings))
                files.Text("effectivity.txt", text + "\n")
        if page:
            page.Text(page.names[0], study.Page(exact, random, savings, seed=options.seed, count=options.count,
                                                solids=options.solids))
    return 0
