"""Figures: of problems and solutions (setting, deformed mesh, contact quantities, history), and of studies.

Here: what draws a problem, a solution or the results of a study, each as a Figure.
Not here: what is drawn; a figure computes nothing that a script could want.

Every function returns a matplotlib Figure and leaves pyplot and its backends alone: DeformedFigure(solution).savefig("u.png").
"""

from .atlas import AtlasFigure
from .bench import GrowthFigure
from .canvas import ZONE_COLOURS
from .comparison import ComparisonFigure
from .contact import ContactFigure
from .deformed import DeformedFigure
from .estimate import ErrorFigure
from .field import FieldFigure
from .history import HistoryFigure
from .law import LawFigure
from .line import LineFigure
from .loadhistory import LoadHistoryFigure
from .meshpicture import MeshFigure
from .setting import SettingFigure
from .studies import AccuracyFigure, ConvergenceFigure, LockingFigure
from .sweep import SweepFigure
from .zones import ZonesFigure
