"""The command that attacks the library: public names called with wrong, extreme and hostile values."""

from __future__ import annotations

from argparse import Namespace

from .arguments import Commands, Natural, Positive
from .files import Files
from .signals import SIGNALS
from .studies import Show

SOLVED = 0.3        # part of the calls that must end with a solution, or the attack would only knock at the door


def AddAttack(commands: Commands) -> None:
    """The parser of the command, added to those of the command line."""
    parser = commands.add_parser("attack", help="call public names with hostile values and count faults", description="Every "
                                 "public name called with wrong, extreme and hostile values, and what comes out solved: only a "
                                 "ProblemError, a NotConvergedError or a SolveInterrupted may come of it.  Every call is a "
                                 "line of attack.jsonl as soon as it is there; a tally at the end, also after Ctrl-C.  Exit "
                                 "code 1 if there is a fault, or less than 30 %% of the calls end with a solution.")
    parser.add_argument("--count", type=Positive, default=2000, help="number of calls (default 2000)")
    parser.add_argument("--seed", type=Positive, default=1, help="seed of the random numbers (default 1)")
    parser.add_argument("--first", type=Natural, default=0, help="number of the first call, to make one again (default 0)")
    parser.add_argument("--limit", type=Positive, default=60, help="seconds after which a call counts as hung (default 60)")
    parser.add_argument("--out", default="results", help="folder for records and tally (default results/)")
    parser.set_defaults(command=RandomAttack)


def RandomAttack(options: Namespace) -> int:
    """Call, record, count."""
    from ..studies.attack.calls import Attack, Line, Tally

    title = f"attack, seed {options.seed}, calls {options.first} to {options.first + options.count - 1}"
    with Files(options.out, "attack.jsonl", "attack.txt") as files:
        print(title, flush=True)
        with files.Growing("attack.jsonl") as file:
            records = Attack(options.seed, range(options.first, options.first + options.count), file, limit=options.limit,
                             callback=lambda record: Show(Line(record)))
        if records:
            print(text := f"{title}\n{Tally(records)}")
            files.Text("attack.txt", text + "\n")
    if len(records) < options.count:
        Show(f"ngdgc: {SIGNALS.words}")
        return SIGNALS.code
    solved = sum(record.outcome == "solution" for record in records)
    return int(any(record.fault for record in records) or solved < SOLVED * len(records))
