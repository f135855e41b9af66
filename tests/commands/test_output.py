"""Progress in a terminal, a notebook and a log; numbers of a solution as JSON."""

import io
import os
import pty
import re
import subprocess
import sys
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from ngdgc import SolveInterrupted, UzawaSolver
from ngdgc.commands import output
from ngdgc.cases import example_4_1
from ngdgc.commands.output import EVERY, FIRST, Progress
from ngdgc.plots import ContactFigure, SettingFigure
from ngdgc.solution.history import Level, Prediction, Step

NUMBER = re.compile(r"iteration +(\d+) ")


def Steps(count):
    return [Step(number, 0.5**number, 0.25**number, number, 0.01 * number) for number in range(1, count + 1)]


def Follow(progress, steps):
    for step in steps:
        progress(step)


def Shown(text):
    return [int(number) for number in NUMBER.findall(text)]


class Screen:
    """A terminal of some width that understands what `Progress` writes; `rows` are the lines that can be read on it."""

    def __init__(self, width):
        self.width, self.rows = width, [""]

    def Feed(self, text):
        for piece in re.findall(r"\x1b\[F|\x1b\[K|\n|[^\x1b\n]+", text):
            if piece == "\x1b[F":
                self.rows.pop()
            elif piece == "\x1b[K":
                self.rows[-1] = ""
            elif piece == "\n":
                self.rows.append("")
            else:
                self.rows[-1] += piece
                while len(self.rows[-1]) > self.width:
                    self.rows[-1:] = [self.rows[-1][:self.width], self.rows[-1][self.width:]]
        return self


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.mark.parametrize("width", [200, 80, 40])
def test_a_terminal_shows_one_line_rewritten(width, monkeypatch):
    """However narrow it is; what is printed next stands on its own line, and the next solve begins another one."""
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", str(width))
    stream = Terminal()
    progress = Progress(stream)
    Follow(progress, Steps(25))
    stream.write("result\n")
    Follow(progress, Steps(3))
    progress.Close()
    rows = Screen(width).Feed(stream.getvalue()).rows
    assert [row[:len("iteration    25")] for row in rows] == ["iteration    25", "result", "iteration     3", ""]
    assert max(map(len, rows)) < width and len(Shown(stream.getvalue())) == 28
    # A terminal narrower than told breaks the lines: the screen above does find that.
    assert len(Screen(30).Feed(stream.getvalue()).rows) > 4


def Lines(reader, count):
    """The next lines of a terminal, which hands them over one by one."""
    text = b""
    while text.count(b"\n") < count:
        text += os.read(reader, 4096)
    return text


def test_a_real_terminal_is_recognised(monkeypatch):
    monkeypatch.setenv("TERM", "xterm")
    reader, writer = pty.openpty()
    with os.fdopen(writer, "w") as stream:
        Follow(Progress(stream), Steps(2))
        assert Lines(reader, 2).count(b"\x1b[F") == 1
        monkeypatch.setenv("TERM", "dumb")
        Follow(Progress(stream), Steps(20))
        assert b"\x1b" not in Lines(reader, 3)
    os.close(reader)


def test_a_log_gets_every_tenth_line_at_once(tmp_path):
    """Each line can be read while the iteration goes on; `Close` adds the last one, once."""
    with open(tmp_path / "log", "w") as stream:
        progress = Progress(stream)
        for step in Steps(3 * EVERY + 5):
            progress(step)
            lines = (tmp_path / "log").read_text().splitlines()
            assert len(lines) == 1 + step.number // EVERY
        progress.Close()
        progress.Close()
    text = (tmp_path / "log").read_text()
    assert Shown(text) == [1, 10, 20, 30, 35] and "\x1b" not in text and "\r" not in text
    assert all(f"{0.5**number:9.2e}" in line for number, line in zip((1, 10, 20, 30, 35), text.splitlines()))


def test_meshes_of_an_adaptive_run_have_lines_of_their_own(monkeypatch):
    """Below the last iteration on them; that of the next mesh rewrites none."""
    monkeypatch.setenv("TERM", "xterm")
    stream = Terminal()
    progress = Progress(stream)
    for dofs in (24, 48):
        Follow(progress, Steps(3))
        progress.Reached(Level(8, dofs, 4, 3, 9, 0, 0.1, 0.2, error=2.4 / dofs))
    rows = Screen(200).Feed(stream.getvalue()).rows
    words = [row.split() for row in rows[:-1]]
    assert [" ".join(row[:2]) for row in words] == ["iteration 3", "24 unknowns:", "iteration 3", "48 unknowns:"]
    assert rows[1].endswith("estimated error 0.1") and rows[3].endswith("estimated error 0.05")


@pytest.fixture
def notebook(monkeypatch):
    """What a notebook is told, [(content, "new" or "update")], and what it calls at the end of a cell, a list."""
    shown, atend = [], []
    events = SimpleNamespace(register=lambda name, call: atend.append(call), unregister=lambda name, call: atend.remove(call))
    ipython = ModuleType("IPython")
    ipython.get_ipython = lambda: SimpleNamespace(kernel=None, events=events)
    ipython.display = ModuleType("IPython.display")

    def display(content, *, raw, display_id):
        shown.append((content["text/plain"], "new"))
        return SimpleNamespace(update=lambda content, raw: shown.append((content["text/plain"], "update")))

    ipython.display.display = display
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    monkeypatch.setitem(sys.modules, "IPython.display", ipython.display)
    return shown, atend


def test_a_notebook_updates_one_line(notebook, monkeypatch, capsys):
    """Not a line for each of 5000 iterations: after the first ones at most ten updates a second, at the end the last."""
    shown, atend = notebook
    clock = iter(np.arange(0, 1000, 0.001))
    monkeypatch.setattr(output.time, "perf_counter", lambda: next(clock))
    progress = Progress()
    Follow(progress, Steps(5000))
    assert Shown(shown[-1][0])[0] < 5000
    (call,) = atend
    call(None)
    numbers = [Shown(text)[0] for text, _ in shown]
    assert [kind for _, kind in shown] == ["new"] + ["update"] * (len(shown) - 1)
    assert numbers[:FIRST] == list(range(1, FIRST + 1)) and numbers[-1] == 5000
    assert FIRST + 10 < len(shown) < FIRST + 5000 * 0.001 / output.PAUSE * 2 and capsys.readouterr().out == "" and not atend
    Follow(progress, Steps(2))
    assert [kind for _, kind in shown[-2:]] == ["new", "update"]


def test_elsewhere_the_standard_output_is_taken(capsys):
    """Also where IPython is there, but no notebook."""
    Follow(Progress(), Steps(1))
    assert Shown(capsys.readouterr().out) == [1]


@pytest.mark.parametrize("live", [True, False])
def test_a_closed_output_does_not_disturb_the_solution(live, monkeypatch):
    """Closed after the third iteration: the solution is that without progress.  A plain writer would raise."""
    monkeypatch.setenv("TERM", "xterm")
    stream = Terminal() if live else io.StringIO()
    progress = Progress(stream)

    def Callback(step):
        if step.number == 3:
            stream.close()
        progress(step)

    expected = example_4_1.Main(n=2, solver=UzawaSolver())
    solution = example_4_1.Main(n=2, solver=UzawaSolver(), callback=Callback)
    progress.Close()
    assert stream.closed and len(solution.history) > 2 * EVERY and np.array_equal(solution.vector, expected.vector)
    with pytest.raises(ValueError):
        example_4_1.Main(n=2, callback=lambda step: stream.write("x"))


def test_a_broken_pipe_does_not_disturb_the_iteration():
    reader, writer = os.pipe()
    os.close(reader)
    stream = os.fdopen(writer, "w")
    progress = Progress(stream)
    Follow(progress, Steps(100))
    assert progress.stream is not stream
    with pytest.raises(BrokenPipeError):
        stream.close()


def test_ctrl_c_keeps_the_last_iterate():
    """What is interrupted inside of the callback, too, has its iterate."""
    def Interrupted(step):
        if step.number == 4:
            raise KeyboardInterrupt

    with pytest.raises(SolveInterrupted, match="interrupted after 4 iterations") as stop:
        example_4_1.Main(n=2, solver=UzawaSolver(), callback=Interrupted)
    solution = stop.value.solution
    assert len(solution.history) == 4 and not solution.converged and solution.normalforce > 0
    assert "NOT CONVERGED" in solution.Report()


@pytest.mark.slow
def test_progress_loads_no_notebook():
    """It asks for IPython only where that is loaded already."""
    code = "import sys, ngdgc.commands.output as o; p = o.Progress(); print('IPython' in sys.modules, p.display)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "None"]


def test_coarser_meshes_show_that_they_go_on():
    """Every mesh begins with a line that says how large it is; a plain function is told of the last mesh alone."""
    stream, steps = io.StringIO(), []
    solution = example_4_1.Main(n=32, callback=Progress(stream))
    lines = stream.getvalue().splitlines()
    sizes = [f"prediction with {level.dofs} unknowns, iteration     1 " for level in solution.levels[:-1]]
    assert sizes and all(any(line.startswith(size) for line in lines) for size in sizes)
    last = [number for number, line in enumerate(lines) if line.startswith("prediction")][-1] + 1
    assert lines[last].startswith("iteration     1 ")
    again = example_4_1.Main(n=32, callback=steps.append)
    assert steps == again.history and not any(isinstance(step, Prediction) for step in steps)


def test_a_log_has_the_last_iteration_on_every_mesh(tmp_path):
    """Of coarser ones too, on which predictions count from one again; one that was shown is not shown twice."""
    stream = io.StringIO()
    progress = Progress(stream)
    for count in (4, 1, 3):
        Follow(progress, Steps(count))
    progress.Close()
    assert Shown(stream.getvalue()) == [1, 4, 1, 1, 3]


def test_figures_of_a_run_are_laid_out_once(tmp_path, monkeypatch):
    """And drawn once: a figure that is placed when it is made has no layout engine any more when it is written."""
    solution, drawn = example_4_1.Main(n=2), []
    monkeypatch.setattr(Figure, "draw", lambda self, renderer, draw=Figure.draw: (drawn.append(self), draw(self, renderer))[1])
    monkeypatch.setattr(ConstrainedLayoutEngine, "execute", lambda self, figure, execute=ConstrainedLayoutEngine.execute: (
        laid.append(figure), execute(self, figure))[1])
    laid = []
    output.DrawInto(lambda: SettingFigure(solution.disc), tmp_path / "a.png")
    assert len(drawn) == 1 and len(laid) == 3
    laid.clear()
    output.DrawInto(lambda: ContactFigure(solution), tmp_path / "b.png")
    assert len(drawn) == 2 and len(laid) == 1
    with open(tmp_path / "b.png", "rb") as file:
        assert file.read(4) == b"\x89PNG"
