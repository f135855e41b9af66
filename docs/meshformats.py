"""What of a mesh is kept by the formats of files: `python docs/meshformats.py` tries all of them and writes meshfiles.md.

Rows of meshio need `pip install meshio`; without it those of the page stay as they are.
"""

import importlib.util
import re
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from netgen.occ import Box, Cylinder, OCCGeometry, Pnt, Z
from ngsolve import CF, Integrate

from ngdgc.meshes import BoxMesh, ReadMesh, RectangleMesh, ShapeMesh
from ngdgc import ProblemError

PAGE = Path(__file__).parent / "meshfiles.md"
HEAD = ("file", "boundary names", "material names", "elements of order 1", "of order 2", "curved sides")
CELLS = {"triangle": 2, "quad": 2, "tet": 3, "hex": 3, "prism": 3}
BEND = 0.2      # height of the arch z = BEND x (1 - x), four times, under the body
# Edges that have a node in their middle, in the order of the formats; corners are numbered alike.
GMSH = {"triangle": (9, ((0, 1), (1, 2), (2, 0))), "quad": (16, ((0, 1), (1, 2), (2, 3), (3, 0))), "line": (8, ((0, 1),)),
        "tet": (11, ((0, 1), (1, 2), (2, 0), (3, 0), (2, 3), (1, 3))),
        "hex": (17, ((0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7))),
        "prism": (18, ((0, 1), (0, 2), (0, 3), (1, 2), (1, 4), (2, 5), (3, 4), (3, 5), (4, 5)))}
FIRST = {"line": 1, "triangle": 2, "quad": 3, "tet": 4, "hex": 5, "prism": 6}
ABAQUS = {"triangle": ("CPE", ((0, 1), (1, 2), (2, 0))), "quad": ("CPE", ((0, 1), (1, 2), (2, 3), (3, 0))),
          "tet": ("C3D", ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))),
          "hex": ("C3D", ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))),
          "prism": ("C3D", ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)))}
SHAPES = {(1, 2): "line", (2, 3): "triangle", (2, 4): "quad", (3, 4): "tet", (3, 6): "prism", (3, 8): "hex"}


class Sample:
    """The unit square or cube, of first or second order, its lowest side straight or an arch.

    points : (n, 3);  groups : [(dim, name, shape, rows of nodes from 1 on)], the body first
    """

    def __init__(self, cells, order=1, bend=0.0, edges=GMSH):
        mesh = RectangleMesh(2, cells=cells) if CELLS[cells] == 2 else BoxMesh(2, cells=cells)
        self.dim, self.cells, self.order, self.bend, self.edges, self.ne = mesh.dim, cells, order, bend, edges, mesh.ne
        places = np.pad(mesh.ngmesh.Coordinates(), ((0, 0), (0, 3 - mesh.dim))).tolist()
        regions = [(mesh.dim, "steel", mesh.Elements())]
        regions += [(mesh.dim - 1, name, mesh.Boundaries(name).Elements()) for name in mesh.GetBoundaries()]
        middles, self.groups = {}, []
        for dim, name, elements in regions:
            for row in [[vertex.nr for vertex in element.vertices] for element in elements]:
                shape = SHAPES[dim, len(row)]
                for edge in edges.get(shape, GMSH.get(shape))[1] if order == 2 else ():
                    pair = tuple(sorted(row[corner] for corner in edge))
                    if pair not in middles:
                        middles[pair] = len(places)
                        places.append([(a + b) / 2 for a, b in zip(*(places[end] for end in pair))])
                    row.append(middles[pair])
                if not (self.groups and self.groups[-1][:3] == (dim, name, shape)):
                    self.groups.append((dim, name, shape, []))
                self.groups[-1][3].append([node + 1 for node in row])
        self.points = np.array(places)
        self.points[:, mesh.dim - 1] += bend * 4 * self.points[:, 0] * (1 - self.points[:, 0])

    def Gmsh(self, version):
        names = list(dict.fromkeys((dim, name) for dim, name, *_ in self.groups))
        tags = {group: number for number, group in enumerate(names, 1)}
        lines = ["$MeshFormat", f"{version} 0 8", "$EndMeshFormat", "$PhysicalNames", str(len(names)),
                 *(f'{dim} {tags[dim, name]} "{name}"' for dim, name in names), "$EndPhysicalNames"]
        rows = [f"{a!r} {b!r} {c!r}" for a, b, c in self.points.tolist()]
        kind = {shape: GMSH[shape][0] if self.order == 2 else FIRST[shape] for shape in FIRST}
        total = sum(len(rows) for *_, rows in self.groups)
        if version == "2.2":
            elements = [f"{kind[shape]} 2 {tags[dim, name]} 1 {' '.join(map(str, row))}"
                        for dim, name, shape, found in self.groups for row in found]
            lines += ["$Nodes", str(len(rows)), *(f"{n} {row}" for n, row in enumerate(rows, 1)), "$EndNodes", "$Elements"]
            return "\n".join([*lines, str(total), *(f"{n} {row}" for n, row in enumerate(elements, 1)), "$EndElements", ""])
        counts = [sum(of == dim for of, _ in names) for dim in range(4)]
        lines += ["$Entities", " ".join(map(str, counts))]
        lines += [f"{tags[group]} 0 0 0 1 1 1 1 {tags[group]} 0" for group in sorted(names)]
        lines += ["$EndEntities", "$Nodes", f"1 {len(rows)} 1 {len(rows)}", f"{self.dim} 1 0 {len(rows)}",
                  *map(str, range(1, len(rows) + 1)), *rows, "$EndNodes", "$Elements", f"{len(self.groups)} {total} 1 {total}"]
        number = 0
        for dim, name, shape, found in self.groups:
            lines.append(f"{dim} {tags[dim, name]} {kind[shape]} {len(found)}")
            lines += [f"{number + n} {' '.join(map(str, row))}" for n, row in enumerate(found, 1)]
            number += len(found)
        return "\n".join([*lines, "$EndElements", ""])

    def Abaqus(self):
        lines = ["*NODE", *(f"{n}, {a!r}, {b!r}, {c!r}" for n, (a, b, c) in enumerate(self.points.tolist(), 1))]
        for dim, name, shape, found in self.groups:
            if dim == self.dim:
                lines.append(f"*ELEMENT, TYPE={ABAQUS[shape][0]}{len(found[0])}, ELSET={name}")
                lines += [", ".join(map(str, [n, *row])) for n, row in enumerate(found, 1)]
        for name in dict.fromkeys(name for dim, name, *_ in self.groups if dim < self.dim):
            nodes = sorted({node for _, of, _, found in self.groups if of == name for row in found for node in row})
            lines += [f"*NSET, NSET={name}", *(f"{node}," for node in nodes)]
        return "\n".join(lines)


def Kept(mesh, sample):
    """{what: is it kept} of a mesh that was read from the file of a sample; names are those of sides of length or area 1."""
    named = dict.fromkeys(name for dim, name, *_ in sample.groups if dim < sample.dim)
    side = {name: Integrate(CF(1), mesh.Boundaries(name), order=12) if name in mesh.GetBoundaries() else 0 for name in named}
    # The lowest and the highest side are arches, the whole body is as large as before.
    points, weights = np.polynomial.legendre.leggauss(30)
    arch = np.sqrt(1 + (4 * sample.bend * points) ** 2) @ weights / 2
    whole = abs(Integrate(CF(1), mesh, order=6) - 1) < 1e-9 and mesh.ne == sample.ne
    around = Integrate(CF(1), mesh.Boundaries(".*"), order=12)
    return {"names": all(abs(value - 1) < 1e-9 for value in side.values()), "materials": mesh.GetMaterials() == ("steel",),
            "whole": whole, "arch": abs(around - 2 * arch - 2 * sample.dim + 2) < 1e-6}


def Read(sample, Write, folder, suffix):
    """`Kept` of a sample that is written and read; None if it is refused."""
    path = Path(folder) / f"part{suffix}"
    try:
        Write(sample, path)
        return Kept(ReadMesh(path), sample)
    except (ProblemError, KeyError):        # meshio does not know prisms of second order
        return None


def Text(Method, *arguments):
    return lambda sample, path: path.write_text(Method(sample, *arguments), encoding="utf-8")


def Row(label, Write, suffix, edges=GMSH):
    """A row of the table for a format that is written as text."""
    with TemporaryDirectory() as folder:
        first = {cells: Read(Sample(cells), Write, folder, suffix) for cells in CELLS}
        second = {cells: Read(Sample(cells, 2, edges=edges), Write, folder, suffix) for cells in CELLS}
        bent = {cells: Read(Sample(cells, 2, BEND, edges), Write, folder, suffix) for cells in CELLS}
    def Cells(found, *wanted):
        kept = [cells for cells, one in found.items() if one and all(one[name] for name in wanted)]
        return "all" if len(kept) == len(CELLS) else ", ".join(kept) or "no"
    names, materials = (all(one and one[what] for one in first.values()) for what in ("names", "materials"))
    refused = [cells for cells, one in bent.items() if one is None]
    curved = Cells(bent, "whole", "arch") + (f"; {', '.join(refused)} refused" if refused and len(refused) < len(CELLS) else "")
    return (label, _Yes(names), _Yes(materials), Cells(first, "whole"), Cells(second, "whole"), curved)


def _Yes(kept):
    return "yes" if kept else "no"


def Netgen():
    """Files of Netgen: what Save writes of structured meshes, and of one with a curved hole."""
    def Write(sample, path):
        mesh = RectangleMesh(2, cells=sample.cells) if sample.dim == 2 else BoxMesh(2, cells=sample.cells)
        mesh.ngmesh.SetMaterial(1, "steel")
        mesh.ngmesh.Save(str(path))
    with TemporaryDirectory() as folder:
        found = {cells: Read(Sample(cells), Write, folder, ".vol") for cells in CELLS}
        mesh = ShapeMesh(Drilled(), 0.5, order=2)
        mesh.ngmesh.Save(folder + "/hole.vol")
        curved = abs(Integrate(CF(1), ReadMesh(folder + "/hole.vol")) - Integrate(CF(1), mesh)) < 1e-9
        mesh.ngmesh.SecondOrder()
        mesh.ngmesh.Save(folder + "/second.vol")
        try:
            second = _Yes(abs(Integrate(CF(1), ReadMesh(folder + "/second.vol")) - Integrate(CF(1), mesh)) < 1e-9)
        except ProblemError:
            second = "refused"
    names, materials = (_Yes(all(one and one[what] for one in found.values())) for what in ("names", "materials"))
    first = "all" if all(one and one["whole"] for one in found.values()) else "no"
    return ("Netgen `.vol`", names, materials, first, second, _Yes(curved))


def Drilled():
    """A box with a hole, whose sides and body have names."""
    shape = Box(Pnt(0, 0, 0), Pnt(1, 1, 1)) - Cylinder(Pnt(0.5, 0.5, 0), Z, r=0.3, h=1)
    for face in shape.faces:
        face.name = "hole" if abs(face.mass - 0.6 * np.pi) < 1e-6 else "side"
    shape.solids[0].name = "steel"
    return shape


def Step():
    """STEP files, which hold shapes: they are meshed when they are read."""
    with TemporaryDirectory() as folder:
        Drilled().WriteStep(folder + "/part.step")
        mesh = ShapeMesh(OCCGeometry(folder + "/part.step").shape, 0.5, order=3)
    names = set(mesh.GetBoundaries()) == {"hole", "side"} and abs(
        Integrate(CF(1), mesh.Boundaries("hole"), order=8) - 0.6 * np.pi) < 1e-3
    curved = abs(Integrate(CF(1), mesh, order=8) - (1 - 0.09 * np.pi)) < 1e-4
    return ("STEP, by `ShapeMesh(OCCGeometry(file).shape, maxh)`", _Yes(names), _Yes(mesh.GetMaterials() == ("steel",)), "tet",
            "any order", _Yes(curved))


def Meshio():
    """What meshio reads and writes as Gmsh 2.2: from the same file of Gmsh, and from VTK, which has no names."""
    import meshio

    def Through(suffix):
        def Write(sample, path):
            path.write_text(sample.Gmsh("2.2"), encoding="utf-8")
            mesh = meshio.read(path)
            if suffix:
                mesh.cell_sets.clear()
                mesh.write(path.with_suffix(suffix))
                mesh = meshio.read(path.with_suffix(suffix))
            mesh.write(path, file_format="gmsh22", binary=False)
        return Write
    return [Row("meshio, Gmsh to Gmsh 2.2", Through(""), ".msh"),
            Row("meshio, VTK (`.vtu`) to Gmsh 2.2", Through(".vtu"), ".msh")]


def Rows():
    """The table, row by row."""
    rows = [Row("Gmsh 2.2 `.msh`, ASCII", Text(Sample.Gmsh, "2.2"), ".msh"), Row("Gmsh 4.1 `.msh`, ASCII", Text(
        Sample.Gmsh, "4.1"), ".msh"), Row("Abaqus, CalculiX `.inp`", Text(Sample.Abaqus), ".inp", ABAQUS), Netgen(), Step()]
    return rows + (Meshio() if importlib.util.find_spec("meshio") else [])


def Lines():
    """The lines of the table in Markdown."""
    return ["| " + " | ".join(row) + " |" for row in [HEAD, ["---"] * len(HEAD), *Rows()]]


def Page():
    """The page with the table as it is now; rows of meshio stay where it is not installed."""
    text, lines = PAGE.read_text(encoding="utf-8"), Lines()
    if not any(line.startswith("| meshio") for line in lines):
        lines += re.findall(r"^\| meshio.*$", text, re.M)
    before, _, rest = text.partition("| " + HEAD[0])
    return before + "\n".join(lines) + "\n" + re.sub(r"\A.*\n(\|.*\n)*", "", rest)


if __name__ == "__main__":
    PAGE.write_text(Page(), encoding="utf-8")
