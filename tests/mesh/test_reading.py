"""Meshes from files: areas, volumes, normals, names, nodes of second order, and a solution that equals one without a file."""

import numpy as np
import pytest
from mistakes.meshes import GMSH, INP, Brick, File
from ngsolve import BND, CF, Integrate, specialcf, x, y, z

from ngdgc import (ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NormalCompliance, ProblemError,
                   Solve)
from ngdgc.meshes import BoxMesh, ReadMesh, RectangleMesh

TYPES = {(2, 3): "CPE3", (2, 4): "CPE4", (3, 4): "C3D4", (3, 6): "C3D6", (3, 8): "C3D8"}


def Volume(mesh):
    """Volume, which the divergence theorem gives once more from the outward normals."""
    volume = Integrate(1, mesh, order=6)
    flux = Integrate(CF((x, y, z)[:mesh.dim]) * specialcf.normal(mesh.dim), mesh, BND, order=6)
    assert flux == pytest.approx(mesh.dim * volume, rel=1e-12)
    return volume


def Rows(mesh):
    """(points (n, 3), rows of the body, {name: rows of its sides}), numbers from 1 on."""
    points = np.pad(mesh.ngmesh.Coordinates(), ((0, 0), (0, 3 - mesh.dim)))
    body = [[vertex.nr + 1 for vertex in element.vertices] for element in mesh.Elements()]
    return points, body, {name: [[vertex.nr + 1 for vertex in element.vertices] for element in mesh.Boundaries(name).Elements()]
                          for name in mesh.GetBoundaries()}


def Abaqus(mesh):
    """A mesh of first order as Abaqus writes it, its sides as node sets."""
    points, body, sides = Rows(mesh)
    lines = ["*NODE", *(f"{n}, {a!r}, {b!r}, {c!r}" for n, (a, b, c) in enumerate(points.tolist(), 1)),
             f"*ELEMENT, TYPE={TYPES[mesh.dim, len(body[0])]}, ELSET=steel",
             *(", ".join(map(str, [n, *row])) for n, row in enumerate(body, 1))]
    for name, rows in sides.items():
        lines += [f"*NSET, NSET={name}", *(f"{node}," for node in sorted({node for row in rows for node in row}))]
    return "\n".join(lines)


def Gmsh(mesh, version):
    """The same as Gmsh writes it in format 2.2 or 4.1."""
    points, body, sides = Rows(mesh)
    groups = [(mesh.dim, "steel", body), *((mesh.dim - 1, name, rows) for name, rows in sides.items())]
    names = "\n".join(f'{dim} {n} "{name}"' for n, (dim, name, _) in enumerate(groups, 1))
    lines = ["$MeshFormat", f"{version} 0 8", "$EndMeshFormat", f"$PhysicalNames\n{len(groups)}\n{names}\n$EndPhysicalNames"]
    kinds = {2: 1, 3: 2, 4: 3 if mesh.dim == 2 or len(body[0]) > 4 else 4, 6: 6, 8: 5}
    counts = [sum(dim == of for of, *_ in groups) for dim in range(4)]
    total = sum(len(rows) for *_, rows in groups)
    if version == 2.2:
        lines += ["$Nodes", f"{len(points)}", *(f"{n} {a!r} {b!r} {c!r}" for n, (a, b, c) in enumerate(points.tolist(), 1)),
                  "$EndNodes", "$Elements", f"{total}"]
        lines += [" ".join(map(str, [1, kinds[len(row)], 2, n, n, *row]))
                  for n, (_, _, rows) in enumerate(groups, 1) for row in rows]
    else:
        lines += ["$Entities", " ".join(map(str, counts)),
                  *(f"{n} 0 0 0 1 1 1 1 {n} 0" for n, (dim, *_) in sorted(enumerate(groups, 1), key=lambda row: row[1][0])),
                  "$EndEntities", "$Nodes", f"1 {len(points)} 1 {len(points)}", f"{mesh.dim} 1 0 {len(points)}",
                  *(str(n) for n in range(1, len(points) + 1)), *(f"{a!r} {b!r} {c!r}" for a, b, c in points.tolist()),
                  "$EndNodes", "$Elements", f"{len(groups)} {total} 1 {total}"]
        for n, (dim, _, rows) in enumerate(groups, 1):
            lines += [f"{dim} {n} {kinds[len(rows[0])]} {len(rows)}", *(" ".join(map(str, [1, *row])) for row in rows)]
    return "\n".join([*lines, "$EndElements", ""])


@pytest.mark.parametrize("mesh", [RectangleMesh(2, upper=(2, 1)), RectangleMesh(2, upper=(2, 1), cells="quad"),
                                  BoxMesh(2, upper=(1, 1, 2)), BoxMesh(2, upper=(1, 1, 2), cells="hex"),
                                  BoxMesh(1, upper=(1, 1, 2), cells="prism")], ids=["triangle", "quad", "tet", "hex", "prism"])
def test_names_sizes_and_normals_are_those_of_the_mesh_that_was_written(mesh, tmp_path):
    mesh.ngmesh.Save(str(tmp_path / "netgen.vol"))
    files = [File(tmp_path, "a.inp", Abaqus(mesh)), tmp_path / "netgen.vol"]
    files += [File(tmp_path, f"{version}.msh", Gmsh(mesh, version)) for version in (2.2, 4.1)]
    for file in files:
        read = ReadMesh(file)
        assert read.ne == mesh.ne and read.nv == mesh.nv
        assert Integrate(1, read) == pytest.approx(2)
        assert set(read.GetBoundaries()) == set(mesh.GetBoundaries())
        if file.suffix != ".vol":
            assert Volume(read) == pytest.approx(2) and read.GetMaterials() == ("steel",)
        for name in mesh.GetBoundaries():
            for weight in (1, x, y, z):
                assert Integrate(weight, read.Boundaries(name)) == pytest.approx(Integrate(weight, mesh.Boundaries(name)))


@pytest.mark.parametrize("written", [Abaqus, lambda mesh: Gmsh(mesh, 4.1)], ids=["inp", "msh"])
def test_solution_equals_that_without_a_file(written, tmp_path):
    """To the accuracy of the solver."""
    def Pressed(mesh):
        foundation = Foundation("bottom", NormalCompliance(stiffness=100, exponent=1))
        problem = ContactProblem(HookeMaterial(E=200, nu=0.3), foundation, dirichlet={"top": CF((0, -0.1))})
        return Solve(Discretization(problem, InteriorPenalty(), mesh, order=1)).Force("bottom")

    mesh = RectangleMesh(4)
    read = ReadMesh(File(tmp_path, "a.inp" if written is Abaqus else "a.msh", written(mesh)))
    assert np.allclose(Pressed(read), Pressed(mesh), rtol=1e-8)
    assert not np.allclose(Pressed(read), Pressed(RectangleMesh(2)), rtol=1e-4)


SECOND = INP.replace("CPE3", "CPE6").replace("1, 1, 2, 3", "1, 1, 2, 3, 4, 5, 6") + """*NODE
4, 1, -0.3
5, 1, 0.5
6, 0, 0.5
"""


def test_nodes_of_second_order_keep_their_places(tmp_path):
    """Two thirds of chord times height lie between a parabola and its chord."""
    assert Volume(ReadMesh(File(tmp_path, "a.inp", INP))) == pytest.approx(1)
    mesh = ReadMesh(File(tmp_path, "b.inp", SECOND))
    assert Volume(mesh) == pytest.approx(1 + 2 / 3 * 2 * 0.3)
    lines = "\n".join(f"{n} {a} {b} 0" for n, (a, b) in enumerate([(0, 0), (2, 0), (0, 1), (1, -0.3), (1, 0.5), (0, 0.5)], 1))
    text = GMSH.replace("3\n1 0 0 0\n2 2 0 0\n3 0 1 0", f"6\n{lines}").replace("2 2 2 1 1 1 2 3", "2 9 2 1 1 1 2 3 4 5 6")
    read = ReadMesh(File(tmp_path, "b.msh", text.replace("1 1 2 2 1 1 2", "1 8 2 2 1 1 2 4")))
    assert Volume(read) == pytest.approx(Volume(mesh)) and read.GetBoundaries() == ("foot", "default")


def test_tetrahedra_of_second_order_keep_their_places(tmp_path):
    """The node on an edge of the unit tetrahedron, moved outwards by d: the map gives 1/6 and what is linear in d."""
    points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (.5, 0, -.1), (.5, .5, 0), (0, .5, 0), (0, 0, .5), (.5, 0, .5),
              (0, .5, .5)]
    nodes = "".join(f"{n}, {a}, {b}, {c}\n" for n, (a, b, c) in enumerate(points, 1))
    mesh = ReadMesh(File(tmp_path, "a.inp", f"*NODE\n{nodes}*ELEMENT, TYPE=C3D10\n1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10\n"))
    # z gains -0.1 times 4 a b of barycentric coordinates a, b; its derivative by z, 0.4 b, has the integral 0.4/24.
    assert Volume(mesh) == pytest.approx(1 / 6 + 0.1 * 4 / 24)


def test_surfaces_and_sections_of_abaqus_win_over_sets(tmp_path):
    text = INP + ("*SURFACE, NAME=contact\nsteel, S1\n*SOLID SECTION, ELSET=steel, MATERIAL=any\n"
                  "*NSET, NSET=all, GENERATE\n1, 3\n")
    mesh = ReadMesh(File(tmp_path, "a.inp", text))
    assert mesh.GetBoundaries() == ("contact", "default") and mesh.GetMaterials() == ("steel",)


# Corners of one element of each type, and the area vectors of its sides S1, S2, ... in the numbering of Abaqus.
SURFACES = {
    "CPE3": ([(0, 0, 0), (2, 0, 0), (0, 1, 0)], [(0, -2), (1, 2), (-1, 0)]),
    "CPE4": ([(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0)], [(0, -2), (1, 0), (0, 2), (-1, 0)]),
    "C3D4": ([(0, 0, 0), (2, 0, 0), (0, 3, 0), (0, 0, 4)], [(0, 0, -3), (0, -4, 0), (6, 4, 3), (-6, 0, 0)]),
    "C3D8": ([(0, 0, 0), (2, 0, 0), (2, 3, 0), (0, 3, 0), (0, 0, 4), (2, 0, 4), (2, 3, 4), (0, 3, 4)],
             [(0, 0, -6), (0, 0, 6), (0, -8, 0), (12, 0, 0), (0, 8, 0), (-12, 0, 0)]),
    "C3D6": ([(0, 0, 0), (2, 0, 0), (0, 3, 0), (0, 0, 4), (2, 0, 4), (0, 3, 4)],
             [(0, 0, -3), (0, 0, 3), (0, -8, 0), (12, 8, 0), (-12, 0, 0)]),
    "C3D5": ([(0, 0, 0), (2, 0, 0), (2, 3, 0), (0, 3, 0), (1, 1.5, 4)],
             [(0, 0, -6), (0, -4, 1.5), (6, 0, 1.5), (0, 4, 1.5), (-6, 0, 1.5)])}


def Nodes(points):
    return "*NODE\n" + "".join(f"{n}, {a}, {b}, {c}\n" for n, (a, b, c) in enumerate(points, 1))


@pytest.mark.parametrize("kind", SURFACES)
@pytest.mark.parametrize("turn", [1, -1], ids=["right", "mirrored"])
def test_sides_of_abaqus_have_its_numbers(kind, turn, tmp_path):
    """Integrals of the outward normal, which differ for all sides of an element; also of elements that are inside out."""
    points, areas = SURFACES[kind]
    text = Nodes([(turn * a, b, c) for a, b, c in points]) + f"*ELEMENT, TYPE={kind}, ELSET=all\n"
    text += ", ".join(map(str, [1, *range(1, len(points) + 1)]))
    text += "".join(f"\n*SURFACE, NAME=side{side}\nall, S{side}" for side in range(1, len(areas) + 1))
    mesh = ReadMesh(File(tmp_path, "a.inp", text))
    assert len(mesh.GetBoundaries()) == len(areas)
    for side, area in enumerate(areas, 1):
        found = Integrate(specialcf.normal(mesh.dim), mesh.Boundaries(f"side{side}"))
        assert np.allclose(found, np.array(area) * ([turn, 1, 1][:mesh.dim]), atol=1e-12)


def test_quadrilaterals_and_tetrahedra_of_second_order_keep_their_places(tmp_path):
    """Two sides are bent by different heights; the other sides and all of the tetrahedron are straight."""
    points = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0), (1, -0.3, 0), (2.2, 0.5, 0), (1, 1, 0), (0, 0.5, 0)]
    tet = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1),
           (.5, 0, 0), (.5, .5, 0), (0, .5, 0), (0, 0, .5), (0, .5, .5), (.5, 0, .5)]
    files = [File(tmp_path, "a.inp", Nodes(points) + "*ELEMENT, TYPE=CPE8\n1, 1, 2, 3, 4, 5, 6, 7, 8\n")]
    for kind, nodes in ((16, points), (11, tet)):
        rows = "\n".join(f"{n} {a} {b} {c}" for n, (a, b, c) in enumerate(nodes, 1))
        numbers = " ".join(map(str, range(1, len(nodes) + 1)))
        text = f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{len(nodes)}\n{rows}\n$EndNodes\n"
        files.append(File(tmp_path, f"{kind}.msh", text + f"$Elements\n1\n1 {kind} 2 0 1 {numbers}\n$EndElements\n"))
    for file, size in zip(files, (2 + 2 / 3 * (2 * 0.3 + 0.2), 2 + 2 / 3 * (2 * 0.3 + 0.2), 1 / 6)):
        assert Volume(ReadMesh(file)) == pytest.approx(size, rel=1e-12)


def test_materials_and_shapes_in_one_file(tmp_path):
    """A square of steel and beside it a triangle of rubber; a section gives another name; groups of Gmsh count by dimension."""
    points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (4, 0, 0)]
    text = Nodes(points) + "*ELEMENT, TYPE=CPE4, ELSET=steel\n1, 1, 2, 3, 4\n*ELEMENT, TYPE=CPE3, ELSET=rubber\n2, 2, 5, 3\n"
    rows = "\n".join(f"{n} {a} {b} {c}" for n, (a, b, c) in enumerate(points, 1))
    gmsh = (f'$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 "foot"\n2 1 "steel"\n2 2 "rubber"\n'
            f"$EndPhysicalNames\n$Nodes\n5\n{rows}\n$EndNodes\n"
            "$Elements\n3\n1 3 2 1 1 1 2 3 4\n2 2 2 2 2 2 5 3\n3 1 2 1 1 1 2\n$EndElements\n")
    sections = "*ELSET, ELSET=soft\n2,\n*SOLID SECTION, ELSET=SOFT\n*SOLID SECTION, ELSET=steel\n"
    for name, content, soft in (("a.inp", text, "rubber"), ("b.inp", text + sections, "SOFT"), ("c.msh", gmsh, "rubber")):
        mesh = ReadMesh(File(tmp_path, name, content))
        assert set(mesh.GetMaterials()) == {"steel", soft} and Volume(mesh) == pytest.approx(2.5)
        assert Integrate(1, mesh.Materials("steel")) == pytest.approx(1)
        assert Integrate(1, mesh.Materials(soft)) == pytest.approx(1.5)
    assert set(mesh.GetBoundaries()) == {"foot", "default"} and Integrate(1, mesh.Boundaries("foot")) == pytest.approx(1)


def test_sets_count_in_steps(tmp_path):
    """The left side has the nodes 1 and 3; with 2 a set would hold all sides, and name none."""
    for step, names in ((2, {"left", "default"}), (1, {"default"})):
        text = INP.split("*NSET")[0] + f"*NSET, NSET=left, GENERATE\n1, 3, {step}\n"
        mesh = ReadMesh(File(tmp_path, "a.inp", text))
        assert set(mesh.GetBoundaries()) == names
        assert step == 1 or Integrate(1, mesh.Boundaries("left")) == pytest.approx(1)


def test_straight_cells_of_second_order_are_those_of_first(tmp_path):
    """Nodes in the middles say nothing; one that is off them is not left out in silence."""
    mesh = ReadMesh(File(tmp_path, "a.inp", Brick(".5, 0, 0")))
    assert mesh.ne == 1 and mesh.nv == 8 and Volume(mesh) == pytest.approx(1)
    with pytest.raises(ProblemError, match="curved hex"):
        ReadMesh(File(tmp_path, "a.inp", Brick(".5, 1e-3, 0")))


def test_orders_that_are_mixed_are_read_if_all_is_straight(tmp_path):
    """A square of eight nodes and beside it a triangle of three."""
    points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (.5, 0, 0), (1, .5, 0), (.5, 1, 0), (0, .5, 0), (3, 0, 0)]
    text = Nodes(points) + "*ELEMENT, TYPE=CPE8\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*ELEMENT, TYPE=CPE3\n2, 2, 9, 3\n"
    mesh = ReadMesh(File(tmp_path, "a.inp", text))
    assert mesh.ne == 2 and mesh.nv == 5 and Volume(mesh) == pytest.approx(2)


def test_sets_that_overlap_are_refused_and_bars_and_empty_decks_name_nothing(tmp_path):
    """Of a cube: a bar of three nodes along an edge, as reinforcement has it, is no side."""
    text = Brick(".5, 0, 0") + "*ELEMENT, TYPE=T3D3, ELSET=bar\n2, 1, 9, 2\n"
    assert ReadMesh(File(tmp_path, "a.inp", text)).GetBoundaries() == ("default",)
    with pytest.raises(ProblemError, match="sides that are in 'foot' and in 'low'; give each one region"):
        ReadMesh(File(tmp_path, "a.inp", Brick(".5, 0, 0") + "*NSET, NSET=foot\n1, 2, 3, 4\n*NSET, NSET=low\n1, 2, 3, 4, 9\n"))
    with pytest.raises(ProblemError, match="has no elements of a body"):
        ReadMesh(File(tmp_path, "a.inp", "*NODE\n1, 0, 0, 0\n"))


@pytest.mark.slow
def test_every_cut_of_a_file_is_refused_or_is_no_loss(tmp_path):
    """Files that end early, at every line, in all formats: an error of ours, or the whole body."""
    mesh = RectangleMesh(2)
    mesh.ngmesh.Save(str(tmp_path / "whole.vol"))
    texts = {".vol": (tmp_path / "whole.vol").read_text(), ".inp": Abaqus(mesh), ".msh": Gmsh(mesh, 2.2)}
    refused = 0
    for suffix, text in texts.items():
        lines = text.splitlines(keepends=True)
        for count in range(len(lines)):
            try:
                read = ReadMesh(File(tmp_path, f"cut{suffix}", "".join(lines[:count])))
                assert suffix == ".inp" or Integrate(1, read) == pytest.approx(1), (suffix, count)
            except ProblemError:
                refused += 1
    assert refused > 100
