"""VTK files: cells with the corners in VTK's order, and contact points with what the law has there."""

from xml.etree import ElementTree

import numpy as np
import pytest
from bodies import Layers, Perforated, Pyramids
from ngsolve import CF, Integrate, Mesh
from problems import Loaded, Solved

from ngdgc import LDG, Conforming, InteriorPenalty
from ngdgc.export import WriteContactVTK, WriteVTK
from ngdgc.mesh.facets import Facets
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.solution.vtkfiles import ElementGrid

# Corners of tetrahedra that fill a cell of VTK, positive if its corners are in VTK's order.
PARTS = {5: [(0, 1, 2)], 9: [(0, 1, 2), (0, 2, 3)], 10: [(0, 1, 2, 3)], 13: [(0, 1, 2, 3), (1, 4, 5, 3), (1, 5, 2, 3)],
         12: [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)]}


def Read(path):
    """{name: array} of a .vtu file with raw appended data, by its XML alone."""
    header, _, raw = path.read_bytes().partition(b'<AppendedData encoding="raw">')
    root, raw = ElementTree.fromstring(header + b"</VTKFile>"), raw[raw.index(b"_") + 1:]
    size, arrays = {"UInt32": "<u4", "UInt64": "<u8"}[root.get("header_type")], {}
    for array in root.iter("DataArray"):
        kind = {"Float64": "<f8", "Int64": "<i8", "UInt8": "<u1"}[array.get("type")]
        start, count = int(array.get("offset")), int(array.get("NumberOfComponents"))
        length = int(np.frombuffer(raw, size, 1, start)[0])
        values = np.frombuffer(raw, kind, length // np.dtype(kind).itemsize, start + np.dtype(size).itemsize)
        arrays[array.get("Name")] = values.reshape(-1, count) if count > 1 else values
    piece = root.find("UnstructuredGrid/Piece")
    assert int(piece.get("NumberOfPoints")) == len(arrays["Points"]) and int(piece.get("NumberOfCells")) == len(arrays["types"])
    return arrays


def Volumes(arrays, swapped=False):
    """Signed volumes, or areas in the plane, of the cells; as a control with the first two corners swapped."""
    volumes, ends = [], arrays["offsets"]
    for kind, start, end in zip(arrays["types"], np.r_[0, ends[:-1]], ends):
        order = [1, 0, *range(2, end - start)] if swapped else range(end - start)
        parts = arrays["Points"][arrays["connectivity"][start:end][order]][np.array(PARTS[int(kind)])]
        edges = parts[:, 1:] - parts[:, :1]
        if parts.shape[1] == 3:
            edges = np.concatenate([edges, np.broadcast_to([0, 0, 3], (len(edges), 1, 3))], axis=1)
        volumes.append(np.linalg.det(edges).sum() / 6)
    return np.array(volumes)


def Mirrored(mesh):
    """The same elements with the x axis turned round: det F < 0 wherever it was positive."""
    net = mesh.ngmesh.Copy()
    for point in net.Points():
        point[0] = 1 - point[0]
    return Mesh(net)


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("mesh", [RectangleMesh(2), RectangleMesh(2, cells="quad"), Layers(2), BoxMesh(1),
                                  BoxMesh(2, cells="hex"), BoxMesh(1, cells="prism")],
                         ids=["triangle", "quad", "free", "tet", "hex", "prism"])
def test_cells_fill_the_body(mesh, order, tmp_path):
    """All volumes are positive and add up to 1, and the fields are those of the solution at the points."""
    solution = Solved(Loaded(mesh), InteriorPenalty(), mesh, order=order)
    arrays = Read(WriteVTK(solution, tmp_path / "body"))
    volumes = Volumes(arrays)
    assert volumes.min() > 0 and volumes.sum() == pytest.approx(1, abs=1e-12)
    assert abs(Volumes(arrays, swapped=True).sum() - 1) > 0.5
    dim, corners = mesh.dim, arrays["connectivity"][:arrays["offsets"][0]]
    middle, mean = arrays["Points"][corners].mean(axis=0), arrays["displacement"][corners].mean(axis=0)
    # A cell is small against the bends of u.
    assert np.abs(mean[:dim] - solution.At(*middle[:dim])).max() < 0.05 * np.abs(arrays["displacement"]).max()


@pytest.mark.parametrize("n", [1, 2, 4])
@pytest.mark.parametrize("mesh", [RectangleMesh(1), RectangleMesh(2, cells="quad"), BoxMesh(1), BoxMesh(1, cells="hex"),
                                  BoxMesh(1, cells="prism"), Pyramids()],
                         ids=["triangle", "quad", "tet", "hex", "prism", "pyramid"])
def test_cells_of_mirrored_meshes(mesh, n):
    for one in (mesh, Mirrored(mesh)):
        grid = ElementGrid(Facets(one), n)
        for kind, cells in grid.cells:
            flat = {"types": np.full(len(cells), kind), "offsets": cells.shape[1] * np.arange(1, len(cells) + 1)}
            # NGSolve keeps 1e-10 away from the tip of a pyramid.
            assert Volumes(flat | {"Points": grid.coordinates, "connectivity": cells.ravel()}).min() > 0
        total = sum(Volumes({"types": np.full(len(cells), kind), "offsets": cells.shape[1] * np.arange(1, len(cells) + 1),
                             "Points": grid.coordinates, "connectivity": cells.ravel()}).sum() for kind, cells in grid.cells)
        assert total == pytest.approx(1, abs=1e-9)


def test_curved_elements_are_followed(tmp_path):
    """Cells on the rim of a hole: the area is that of the curved elements up to the square of the size of a cell."""
    mesh = Perforated()
    areas = [abs(Volumes(Read(WriteVTK(Solved(Loaded(mesh), LDG(), mesh, order=order), tmp_path / "plate"))).sum()
                 - Integrate(CF(1), mesh)) for order in (2, 3)]
    assert 0 < areas[1] < 0.3 * areas[0]


@pytest.mark.parametrize("method", [LDG(), Conforming()], ids=lambda method: method.name)
@pytest.mark.parametrize("mesh", [RectangleMesh(4), BoxMesh(1)], ids=["2D", "3D"])
def test_contact_points(mesh, method, tmp_path):
    """Every contact point is one cell with what the solution has there; weights integrate the pressure."""
    solution = Solved(Loaded(mesh), method, mesh)
    path = WriteContactVTK(solution, tmp_path / "contact")
    arrays, dim = Read(path), mesh.dim
    assert path.name == "contact.vtu" and np.all(arrays["types"] == 1)
    assert np.array_equal(arrays["connectivity"], np.arange(len(solution.points)))
    assert np.array_equal(arrays["Points"][:, :dim], solution.points)
    for name in ("pressure", "bound", "penetration", "zones", "weights"):
        assert np.array_equal(arrays[name], getattr(solution, name))
    for name in ("friction", "slip", "displacement", "normals"):
        assert np.array_equal(arrays[name][:, :dim], getattr(solution, name)) and np.all(arrays[name][:, dim:] == 0)
    assert arrays["weights"] @ arrays["pressure"] == pytest.approx(solution.normalforce, rel=1e-14)
    assert np.array_equal(arrays["gap"], solution.disc.contact.gap) and np.ptp(arrays["pressure"]) > 0.1
