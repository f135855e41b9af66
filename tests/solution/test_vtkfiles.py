"""VTK files: cells with the corners in VTK's order, and contact points with what the law has there."""

from xml.etree import ElementTree

import numpy as np
import pytest
from bodies import LINE, Crossed, Layers, Perforated, Pyramids
from ngsolve import CF, QUAD, SEGM, TRIG, Integrate, IntegrationRule, Mesh, Norm, Parameter
from problems import Loaded, Solved

from ngdgc import (LDG, Conforming, ContactProblem, CoulombFriction, Discretization, Foundation, HookeMaterial,
                   InteriorPenalty, Joint, NormalCompliance, SolveHistory)
from ngdgc.export import WriteContactVTK, WriteSeries, WriteVTK
from ngdgc.mesh.facets import Facets
from ngdgc.mesh.quadrature import ContactRules
from ngdgc.meshes import BoxMesh, RectangleMesh
from ngdgc.solution.fields import SpatialStress
from ngdgc.solution.pointcells import PointCells
from ngdgc.solution.vtkfiles import ElementGrid

# Corners of tetrahedra that fill a cell of VTK, positive if its corners are in VTK's order.
PARTS = {5: [(0, 1, 2)], 9: [(0, 1, 2), (0, 2, 3)], 10: [(0, 1, 2, 3)], 13: [(0, 1, 2, 3), (1, 4, 5, 3), (1, 5, 2, 3)],
         12: [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)]}


def Read(path):
    """{name: array} of a .vtu file with raw appended data, by its XML alone; names of fields of cells begin with "cell "."""
    header, _, raw = path.read_bytes().partition(b'<AppendedData encoding="raw">')
    root, raw = ElementTree.fromstring(header + b"</VTKFile>"), raw[raw.index(b"_") + 1:]
    size, arrays = {"UInt32": "<u4", "UInt64": "<u8"}[root.get("header_type")], {}
    ofcells = set(root.iterfind(".//CellData/DataArray"))
    for array in root.iter("DataArray"):
        kind = {"Float64": "<f8", "Int64": "<i8", "UInt8": "<u1"}[array.get("type")]
        start, count = int(array.get("offset")), int(array.get("NumberOfComponents"))
        length = int(np.frombuffer(raw, size, 1, start)[0])
        values = np.frombuffer(raw, kind, length // np.dtype(kind).itemsize, start + np.dtype(size).itemsize)
        arrays["cell " * (array in ofcells) + array.get("Name")] = values.reshape(-1, count) if count > 1 else values
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


def Named():
    """The cube of pyramids with names on its sides."""
    mesh = Pyramids()
    for number, name in enumerate(("bottom", "top", "front", "right", "back", "left")):
        mesh.ngmesh.SetBCName(number, name)
    return Mesh(mesh.ngmesh)


def Bent(cells):
    """Elements whose sides are not flat, positive all the same."""
    net = BoxMesh(2, cells=cells).ngmesh.Copy()
    for point in net.Points():
        a, b, c = point.p
        point[0], point[2] = a + 0.15 * c * (1 - b) * a * (1 - a), c * (1 + 0.2 * a * b * (1 - c))
    return Mesh(net)


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 3])
@pytest.mark.parametrize("mesh", [RectangleMesh(2), RectangleMesh(2, cells="quad"), Perforated(), BoxMesh(1),
                                  BoxMesh(1, cells="hex"), BoxMesh(1, cells="prism"), Named(), Bent("hex"), Bent("prism")],
                         ids=["triangle", "quad", "curved", "tet", "hex", "prism", "pyramid", "bent hex", "bent prism"])
def test_cell_values_integrate_to_those_of_the_elements(mesh, order, tmp_path):
    """Sums of value times size, in every element, are the integrals: exact for polynomials, so to round-off."""
    if mesh.dim == 3 and mesh.ne > 6:
        order = min(order, 2)       # enough points within an element
    solution = Solved(Loaded(mesh), LDG(), mesh, order=order)
    arrays = Read(WriteVTK(solution, tmp_path / "body"))
    sizes, quadrature = arrays["cell weights"], 3 * max(order, mesh.GetCurveOrder())
    assert sizes.min() > 0 and sizes.sum() == pytest.approx(Integrate(CF(1), mesh), rel=3e-2)
    if not np.any(np.isin(arrays["types"], (12, 13))) or mesh.ne <= 2:     # VTK cuts bent sides otherwise than `Volumes`
        assert np.abs(sizes - Volumes(arrays)).max() < 1e-12
    for name, field in (("stress", SpatialStress(solution)), ("displacement", solution.gfu)):
        exact = np.ravel(Integrate(field, mesh, order=quadrature))
        whole = (sizes @ arrays[f"cell {name}"])[:len(exact)]
        scale = Integrate(Norm(field), mesh)
        # NGSolve keeps 1e-10 away from the tip of a pyramid.
        assert np.abs(whole - exact).max() < 1e-9 * scale
        corners = np.split(arrays["connectivity"], arrays["offsets"][:-1])
        means = np.array([arrays[name][own].mean(axis=0) for own in corners])
        # The control: means of the corners of cells are off by the bends of the field within them.
        assert order == 1 or np.abs((sizes @ means)[:len(exact)] - exact).max() > 1e-7 * scale
        assert np.abs(means - arrays[f"cell {name}"]).max() < 0.2 * np.abs(means).max()


def Corners(arrays):
    return [arrays["Points"][own] for own in np.split(arrays["connectivity"], arrays["offsets"][:-1])]


def Size(corners):
    """Length of a segment or area of a plane polygon in space."""
    if len(corners) == 2:
        return np.linalg.norm(corners[1] - corners[0])
    return np.linalg.norm(np.cross(corners[1:-1] - corners[0], corners[2:] - corners[0]).sum(axis=0)) / 2


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("method", [LDG(), Conforming()], ids=lambda method: method.name)
@pytest.mark.parametrize("mesh", [RectangleMesh(4), BoxMesh(1), BoxMesh(1, cells="hex")], ids=["2D", "tet", "hex"])
def test_contact_cells(mesh, method, order, tmp_path):
    """A cell around every contact point, as large as its weight, with what the solution has there."""
    solution = Solved(Loaded(mesh), method, mesh, order=order)
    path = WriteContactVTK(solution, tmp_path / "contact")
    arrays, dim, contact = Read(path), mesh.dim, solution.disc.contact
    assert path.name == "contact.vtu" and np.all(arrays["types"] == (3 if dim == 2 else 7))
    members, weights, cells = contact.members, arrays["cell weights"], Corners(arrays)
    assert np.array_equal(arrays["cell point"], members)
    for name in ("pressure", "bound", "penetration", "zones"):
        assert np.array_equal(arrays[f"cell {name}"], getattr(solution, name)[members])
    for name in ("friction", "slip", "displacement", "normals"):
        field = arrays[f"cell {name}"]
        assert np.array_equal(field[:, :dim], getattr(solution, name)[members]) and np.all(field[:, dim:] == 0)
    assert np.array_equal(arrays["cell gap"], contact.gap[members]) and np.ptp(arrays["cell pressure"]) > 0.1
    # Areas solve a system of equations to 1e-13.
    sizes = np.array([Size(cell) for cell in cells])
    assert np.abs(sizes - weights).max() < 1e-12 and np.bincount(members, weights) == pytest.approx(solution.weights, rel=1e-13)
    assert sizes @ arrays["cell pressure"] == pytest.approx(solution.normalforce, rel=1e-12)
    lengths = solution.ZoneLengths().values()
    assert np.bincount(arrays["cell zones"], sizes, 3) == pytest.approx(np.array(list(lengths)), abs=1e-12)
    # Cells lie about their points, and on Gamma_C, which is y = 0 or z = 0.
    middles = np.array([cell.mean(axis=0) for cell in cells])[:, :dim]
    here = np.linalg.norm(middles - solution.points[members], axis=1)
    assert np.all(here <= [1.2 * np.ptp(cell, axis=0).max() for cell in cells])
    assert here.sum() < np.linalg.norm(np.roll(middles, 1, axis=0) - solution.points[members], axis=1).sum()
    assert np.abs(middles[:, dim - 1]).max() < 1e-14
    # At the corners u_h, of the element that the cell lies on.
    inside = np.concatenate([middle + 0.99 * (cell[:, :dim] - middle) for cell, middle in zip(cells, middles)])
    near = np.array([solution.At(*point[:-1], 1e-9) for point in inside])
    assert np.abs(arrays["displacement"][:, :dim] - near).max() < 0.02 * np.abs(near).max()


def test_contact_cells_of_a_curved_side(tmp_path):
    """Cells have straight sides, so sizes are off by the square of theirs; weights are not."""
    mesh = Perforated()
    foundation = Foundation("hole", NormalCompliance(100), gap=-0.01)
    solution = Solved(ContactProblem(HookeMaterial(E=200, nu=0.3), foundation, dirichlet={"top": (0, 0)}), LDG(), mesh)
    arrays = Read(WriteContactVTK(solution, tmp_path / "contact"))
    sizes = np.array([Size(cell) for cell in Corners(arrays)])
    assert arrays["cell weights"] @ arrays["cell pressure"] == pytest.approx(solution.normalforce, rel=1e-13)
    assert 1e-7 < 1 - sizes.sum() / solution.weights.sum() < 1e-2


@pytest.mark.slow
@pytest.mark.parametrize("order", range(1, 7))
@pytest.mark.parametrize("method", [LDG(), Conforming()], ids=lambda method: method.name)
def test_point_cells_cut_a_side_by_the_weights(method, order):
    rules = ContactRules(method, 3, order)
    for et, side in ((TRIG, 0.5), (QUAD, 1)):
        rule = rules[et] if isinstance(rules, dict) else IntegrationRule(et, rules)
        cells = PointCells(et, rule)
        areas = np.array([Size(np.pad(cell, ((0, 0), (0, 1)))) for cell in cells])
        assert np.abs(areas - rule.weights).max() < 1e-12 and areas.sum() == pytest.approx(side, abs=1e-12)
        for cell in cells:      # convex, and so without overlap if the areas add up within the side
            edges = np.roll(cell, -1, axis=0) - cell
            turns = np.linalg.det(np.stack([edges, np.roll(edges, -1, axis=0)], axis=1))
            assert turns.min() > -1e-12 and cell.min() > -1e-12
            assert cell.sum(axis=1).max() < 1 + 1e-12 if et == TRIG else cell.max() < 1 + 1e-12


def test_cells_of_a_segment_follow_its_points():
    """In whatever order they are given."""
    cells = PointCells(SEGM, IntegrationRule([(0.8,), (0.1,), (0.5,)], [0.3, 0.4, 0.3]))
    assert np.array(cells)[..., 0] == pytest.approx(np.array([(0.7, 1), (0, 0.4), (0.4, 0.7)]))


def Collection(path):
    """(time, part, name of the file) of a .pvd file."""
    return [(float(one.get("timestep")), one.get("part"), one.get("file")) for one in ElementTree.parse(path).iter("DataSet")]


def test_series_of_a_history(tmp_path):
    """A body and its contact at every time, in files as those of one solution."""
    history = Led()
    path = WriteSeries(history, tmp_path / "led")
    found = Collection(path)
    assert path.name == "led.pvd" and [time for time, *_ in found] == [0.5, 0.5, 1, 1]
    assert [(part, file) for _, part, file in found[:3]] == [
        ("0", "led/body-0000.vtu"), ("1", "led/contact-0000.vtu"), ("0", "led/body-0001.vtu")]
    for number, solution in enumerate(history):
        for Write, name in ((WriteVTK, "body"), (WriteContactVTK, "contact")):
            single = Write(solution, tmp_path / name).read_bytes()
            assert single == (tmp_path / f"led/{name}-{number:04d}.vtu").read_bytes()
    assert (tmp_path / "led/body-0000.vtu").read_bytes() != (tmp_path / "led/body-0001.vtu").read_bytes()
    for times, wanted in ((None, [1, 1, 2, 2]), ((0, 0.1), [0, 0, 0.1, 0.1])):
        path = WriteSeries(list(history), tmp_path / "two.pvd", times=times)
        assert [time for time, *_ in Collection(path)] == wanted


def Led():
    t = Parameter(0)
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), Foundation("bottom", NormalCompliance(1e4)),
                             dirichlet={"top": CF((0.01 * t, -0.02 * t))})
    return SolveHistory(Discretization(problem, LDG(), RectangleMesh(2)), parameter=t, times=[0.5, 1])


@pytest.mark.slow
@pytest.mark.parametrize("method", [LDG(), Conforming()], ids=lambda method: method.name)
@pytest.mark.parametrize("mesh", [Layers(2), Layers(3), Crossed({"mid": [LINE[1:5]]})], ids=["2D", "3D", "inside"])
def test_contact_cells_of_a_joint(mesh, method, tmp_path):
    """On its first side, whose displacement is at the corners; of conforming elements the ends of a joint are no points."""
    laws, up = {"compliance": NormalCompliance(50), "friction": CoulombFriction(0.3)}, (0,) * (mesh.dim - 2)
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), [Foundation("bottom", **laws), Joint("mid", **laws)],
                             dirichlet={"top": (0.01, *up, -0.03)})
    solution = Solved(problem, method, mesh, order=2)
    arrays, contact, dim = Read(WriteContactVTK(solution, tmp_path / "contact")), solution.disc.contact, mesh.dim
    sizes, members = np.array([Size(cell) for cell in Corners(arrays)]), arrays["cell point"]
    assert np.array_equal(members, contact.members) and np.abs(sizes - arrays["cell weights"]).max() < 1e-12
    assert np.bincount(members, sizes) == pytest.approx(contact.weights, rel=1e-12)
    assert sizes @ arrays["cell pressure"] == pytest.approx(solution.normalforce, rel=1e-12)
    on = np.repeat(contact.joined[members], np.diff(arrays["offsets"], prepend=0))
    middles = np.repeat([cell.mean(axis=0) for cell in Corners(arrays)], np.diff(arrays["offsets"], prepend=0), axis=0)
    inward = np.repeat(contact.normals[members], np.diff(arrays["offsets"], prepend=0), axis=0)
    inside = (middles + 0.999 * (arrays["Points"] - middles))[:, :dim] - 1e-3 * inward
    near = np.array([solution.At(*point) for point in inside[on]])
    found = arrays["displacement"][on, :dim]
    other = np.array([solution.At(*point) for point in (inside + 2e-3 * inward)[on]])
    assert np.abs(found - near).max() < 0.2 * np.abs(found - other).max()
