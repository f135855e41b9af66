"""The commands before a solution: a case to begin with, what it is and costs, what is in the file of a mesh."""

import re
from pathlib import Path

import numpy as np
import pytest
from bodies import Layers, Perforated, Pyramids
from netgen.occ import WorkPlane
from ngsolve import Mesh

from ngdgc.cases import step_part
from ngdgc.cli import Main
from ngdgc.commands.check import Cost
from ngdgc.commands.meshfile import MeshWords
from ngdgc.mesh.quality import ShapeQuality
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.plots import MeshFigure

PAGE = Path(__file__).parents[2] / "docs" / "performance.md"


@pytest.mark.slow
def test_a_new_case_can_be_checked_and_run_at_once(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert Main(["new", "block.py"]) == 0
    assert Main(["check", "block.py", "--n", "4"]) == 0
    shown = capsys.readouterr().out
    for words in ("top       4      20      (10, 10)  (0, 1)", "32 triangles", "foundation  bottom", "dirichlet   top",
                  "(1, -0.5)", "free        right, left", "held     by supports", "384 unknowns by sparsecholesky"):
        assert words in shown
    assert (tmp_path / "results" / "setting.png").stat().st_size > 5000
    assert Main(["run", "block.py", "--n", "4"]) == 0
    shown = capsys.readouterr().out
    assert "int p_n" in shown and "[N/mm]" in shown and "[stress" not in shown and "[length" not in shown
    # The row of its `Compare`, which is a balance.
    assert re.search(r"force on the plate \[N/mm\] +(\S+) +\1 ", shown)


@pytest.mark.slow
def test_interfaces_in_the_body_are_not_called_free(tmp_path, capsys):
    assert Main(["check", "two_rollers", "--n", "4", "--out", str(tmp_path)]) == 0
    shown = capsys.readouterr().out
    assert "free        side\n" in shown and "inside the body" in shown


@pytest.mark.slow
def test_nothing_is_solved_by_a_check(tmp_path, capsys, monkeypatch):
    """Not even a case that nobody could wait for; loads are summed up, over all that carries them."""
    monkeypatch.setattr("ngdgc.solvers.driver.Drive", None)
    assert Main(["check", "machine_part", "--n", "4", "--out", str(tmp_path)]) == 0
    shown = capsys.readouterr().out
    assert "loads    (1500, 0, -6000) [N] in all" in shown and "by contact alone against" in shown
    assert re.search(r"gasket +\d+ +3\d\d\d\.?\d* .*\(0, 0, -1\)", shown)


def test_what_holds_no_body_is_said(tmp_path, capsys, monkeypatch):
    """The checks of a run, in one line."""
    monkeypatch.chdir(tmp_path)
    assert Main(["new", "block.py"]) == 0
    text = (tmp_path / "block.py").read_text()
    (tmp_path / "wrong.py").write_text(text.replace('dirichlet={"top"', 'dirichlet={"topp"'))
    assert Main(["check", "wrong.py"]) == 2
    assert "'topp' matches no boundary of the mesh" in capsys.readouterr().err


def test_cost_is_that_of_the_performance_page():
    """Within the factor that is said, for all but nearly incompressible bodies."""
    text = PAGE.read_text(encoding="utf-8")
    rows = 0
    for part in text.split("\n## ")[1:]:
        dim = 3 if "Box" in part or re.search(r"n = (6|11|4|5) ", part) else 2
        for label, unknowns, *numbers in re.findall(
                r"^\| (\w[^|]*), n = \d+ \| (\d+) \|(?: [\d.]+ \|){5} ([\d.]+) \|.*\| ([\d.]+) \|$", part, re.M):
            if "nearly incompressible" in part or not (order := re.search(r"k = (\d)", label)):
                continue
            seconds, memory = Cost(int(unknowns), dim, int(order[1]))
            total, peak = map(float, numbers)
            assert 1 / 3 < seconds / total < 3 and 1 / 3 < memory / (peak * 2 ** 30) < 3, (part[:40], label, unknowns)
            rows += 1
    assert rows > 10


@pytest.mark.parametrize("mesh", [RectangleMesh(2, cells="quad"), BoxMesh(2, cells="hex")], ids=["quad", "hex"])
def test_cubes_are_the_best_shapes(mesh):
    assert ShapeQuality(mesh) == pytest.approx(1)


def test_quality_counts_neither_size_nor_place_but_flatness():
    """Of a right isosceles triangle sqrt(3)/2, by hand; of a body pressed flat by e that of every type goes to zero."""
    assert ShapeQuality(RectangleMesh(3, lower=(5, 5), upper=(8, 8))) == pytest.approx(np.sqrt(3) / 2)
    for mesh in (RectangleMesh(2), RectangleMesh(2, cells="quad"), BoxMesh(2), BoxMesh(2, cells="hex"),
                 BoxMesh(2, cells="prism"), Pyramids()):
        before, net = ShapeQuality(mesh), mesh.ngmesh.Copy()
        for point in net.Points():
            point[mesh.dim - 1] = 1e-3 * point[mesh.dim - 1]
        flat = ShapeQuality(Mesh(net))
        assert before.min() > 0.5 and flat.max() < 0.03 and flat.min() > 0


def test_words_of_a_mesh():
    """Sizes and normals of the regions, of a hole by its own outward normal, which is 0 in the mean, and interfaces."""
    words = MeshWords(Perforated())
    assert "geometry of order 2" in words and re.search(r"hole +\d+ +1\.256\d* +\(0\.5, 0\.5\) +\(-?0, -?0\)", words)
    assert re.search(r"left +\d+ +1 +\(0, 0\.5\) +\(-1, 0\)", words)
    assert f"{1 - np.pi * 0.04:.4g}"[:5] in words
    layers = MeshWords(Layers(2))
    assert re.search(r"mid +\d+ +1 +\(0\.5, 0\.4\) +inside the body", layers) and re.search(r"soft +\d+ +0\.4", layers)
    flat = BoxMesh(2, upper=(1, 1, 0.001))
    assert "48 elements below 0.1: mesh anew" in MeshWords(flat) and "mesh anew" not in words


def test_picture_of_a_mesh():
    """Every named region has its name beside it, and every element an outline."""
    figure = MeshFigure(Perforated())
    assert {text.get_text() for text in figure.axes[0].texts} == {"left", "right", "bottom", "top", "hole"}
    outlines = next(one for one in figure.axes[0].collections if one.get_gid() == "outlines")
    assert len(outlines.get_paths()) == Perforated().ne
    solid = MeshFigure(BoxMesh(2, cells="prism"))
    assert [{text.get_text() for text in axes.texts} for axes in solid.axes] == [
        {"left", "front", "bottom"}, {"right", "back", "top"}]


def test_a_file_that_is_read(tmp_path, capsys):
    BoxMesh(2, cells="hex").ngmesh.Save(str(tmp_path / "box.vol"))
    assert Main(["mesh", str(tmp_path / "box.vol"), "--out", str(tmp_path / "out")]) == 0
    shown = capsys.readouterr().out
    assert "8 hexahedra, 27 vertices" in shown and re.search(r"top +4 +1 +\(0\.5, 0\.5, 1\) +\(0, 0, 1\)", shown)
    assert (tmp_path / "out" / "mesh.png").read_bytes().startswith(b"\x89PNG")
    (tmp_path / "no.vol").write_text("hello")
    assert Main(["mesh", str(tmp_path / "no.vol")]) == 2 and "is no mesh of Netgen" in capsys.readouterr().err


@pytest.mark.slow
def test_a_step_file_is_meshed(tmp_path, capsys):
    """With the names of its faces, and curved: the bore of radius 14 through 30 mm."""
    file = str(Path(step_part.__file__).with_name("step_part.step"))
    assert Main(["mesh", file, "--maxh", "12", "--out", str(tmp_path)]) == 0
    shown = capsys.readouterr().out
    assert "geometry of order 2" in shown and (tmp_path / "mesh.png").stat().st_size > 5000
    area = float(re.search(r"bore +\d+ +([\d.]+)", shown)[1])
    assert area == pytest.approx(2 * np.pi * 14 * 30, rel=1e-3)


@pytest.mark.slow
def test_what_the_template_leaves_out_can_be_taken_in(tmp_path, capsys, monkeypatch):
    """Every line of data that is a comment, one after the other, and meshes from a file or a shape in place of its own."""
    monkeypatch.chdir(tmp_path)
    assert Main(["new", "block.py"]) == 0
    text = Path("block.py").read_text()
    lines = re.findall(r"^        # (\w+)=", text, re.M)
    assert lines == ["roller", "traction", "force", "bodyforce"]
    for name in lines:
        Path("other.py").write_text(text.replace(f"        # {name}=", f"        {name}="))
        assert Main(["check", "other.py", "--n", "4"]) == 0
        assert re.search(rf"^{name} ", capsys.readouterr().out, re.M)
    RectangleMesh(2, upper=(20, 10), cells="quad").ngmesh.Save("part.vol")
    plate = WorkPlane().Rectangle(20, 10).Face()
    for edge, name in zip(plate.edges, ("bottom", "right", "top", "left")):
        edge.name = name
    plate.WriteStep("part.step")
    own = text.index("    return RectangleMesh")
    for begin, words in (("    #   from pathlib", "4 quadrilaterals"), ("    #   from netgen", "triangles")):
        start = text.index(begin)
        block = text[start:text.index("\n\n", start)].split("    # A ")[0].replace("    #   ", "    ")
        rest = "\n\n" + text[text.index("def Problem"):]
        Path("other.py").write_text(text[:own] + block.replace("part.msh", "part.vol") + rest)
        assert Main(["check", "other.py", "--n", "4"]) == 0
        assert words in capsys.readouterr().out
