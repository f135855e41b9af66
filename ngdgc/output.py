"""What a run shows and leaves: progress of the iteration, and a folder with report, figures, page, VTK and solution."""

import json


class Progress:
    """A callback that shows every iteration: one line rewritten in a terminal, every tenth iteration in a file."""

    def __init__(self, stream):
        self.stream, self.live = stream, stream.isatty()
        self.written = False

    def __call__(self, step):
        line = (f"iteration {step.number:5d}   change {step.change:9.2e}   distance to the law {step.residual:9.2e}   "
                f"{step.seconds:7.2f} s")
        if self.live:
            self.stream.write("\r" + line)
            self.written = True
        elif step.number == 1 or step.number % 10 == 0:
            self.stream.write(line + "\n")
        self.stream.flush()

    def Close(self):
        if self.written:
            self.stream.write("\n")


def WriteResults(solution, folder, *, scale=1.0):
    """Write report, figures, page, VTK and solution into `folder`; the list of names.

    `scale` multiplies the displacement in the pictures; with another scale than 1 the deformed body is drawn at that scale
    too.
    """
    from .export import WriteHTML, WriteVTK
    from .plots import ContactFigure, DeformedFigure, HistoryFigure, SettingFigure

    (folder / "report.txt").write_text(solution.Report(), encoding="utf-8")
    (folder / "report.json").write_text(json.dumps(solution.ToJSON(), indent=2) + "\n", encoding="utf-8")
    solution.Save(folder / "solution")
    WriteHTML(solution, folder / "solution.html", scale=scale)
    WriteVTK(solution, folder / "solution.vtu")
    written = ["report.txt", "report.json", "solution/", "solution.html", "solution.vtu"]
    figures = {"setting": SettingFigure(solution.disc), "deformed": DeformedFigure(solution),
               "contact": ContactFigure(solution), "history": HistoryFigure(solution)}
    if scale != 1:
        figures["deformed-scaled"] = DeformedFigure(solution, scale=scale)
    for name, figure in figures.items():
        figure.savefig(folder / f"{name}.png", dpi=150)
        written.append(f"{name}.png")
    return written
