"""Scenes of NGSolve's viewer: what it gets is the deformed body at its scale, for load steps in common colours."""

import html
import json
import re
from base64 import b64decode

import numpy as np
import pytest
from ngsolve import CF

from ngdgc import (Conforming, ContactProblem, Discretization, Foundation, HookeMaterial, InteriorPenalty, NestedNewtonSolver,
                   NormalCompliance, ProblemError)
from ngdgc.cases import example_4_2
from ngdgc.export import Animation, Scene, WriteHTML
from ngdgc.meshes import BoxMesh

SINGLE = 1e-6       # the viewer gets single precision; lengths are of size 1


@pytest.fixture(scope="module")
def ip():
    return example_4_2.Main(n=4)


@pytest.fixture(scope="module")
def steps():
    """Example 4.2 under a quarter, a half and the whole of its load."""
    whole, mesh = example_4_2.Problem(), example_4_2.Mesh(4)
    problems = [ContactProblem(whole.material, whole.foundation, dirichlet={"top": CF((0, 0))},
                               traction={"left": CF((880 * part, 0))}) for part in (0.25, 0.5, 1)]
    return [NestedNewtonSolver().Solve(Discretization(problem, InteriorPenalty(), mesh, order=1)) for problem in problems]


def Given(page):
    """What a page hands to the viewer."""
    return json.loads(re.search(r"var render_data = (.*)\n", page).group(1))


def Corners(state):
    """Positions and function values (triangles, 3, 4) of a state of order 1."""
    corners = [np.frombuffer(b64decode(points), "<f4").reshape(-1, 4) for points in state["Bezier_trig_points"]]
    return np.stack(corners, axis=1)


def Middles(solution):
    vertices = solution.disc.mesh.ngmesh.Coordinates()
    return np.array([vertices[[vertex.nr for vertex in element.vertices]].mean(axis=0)
                     for element in solution.disc.mesh.Elements()])[:, :2]


@pytest.mark.parametrize("scale", [1, 2.5])
def test_the_viewer_gets_the_deformed_body_at_its_scale(ip, scale):
    """The middle of a P1 element moves by scale u_h there, and by no other multiple; the first state is at rest.

    Colours are |u_h| in both.
    """
    data = Given(Scene(ip, scale=scale).Page())
    rest, deformed = (Corners(state) for state in data["ngdgc"]["states"])
    middles = Middles(ip)
    u = np.array([ip.At(*middle) for middle in middles])
    assert np.abs(rest[..., :2].mean(axis=1) - middles).max() < SINGLE
    moved = deformed[..., :2].mean(axis=1) - middles
    assert np.abs(moved - scale * u).max() < 10 * SINGLE and np.abs(moved - 2 * scale * u).max() > 0.1
    assert np.array_equal(rest[..., 3], deformed[..., 3])
    assert np.array_equal(Corners(data), deformed) and data["ngdgc"]["smooth"]


def test_load_steps_share_colours_and_camera(steps):
    """Each state is its own solution, in the order given; a scene of one of them has another range."""
    data = Given(Animation(steps).Page())
    states, labels = data["ngdgc"]["states"], data["ngdgc"]["labels"]
    assert len({(state["funcmin"], state["funcmax"], state["mesh_radius"]) for state in states}) == 1
    largest = [Corners(state)[..., 3].max() for state in states]
    assert np.all(np.diff(largest) > 0) and states[0]["funcmax"] == pytest.approx(largest[-1], rel=SINGLE)
    assert Given(Scene(steps[0]).Page())["funcmax"] == pytest.approx(largest[0], rel=SINGLE)
    for label, number, value in zip(labels, range(1, 4), largest):
        assert label.startswith(f"step {number} of 3, max |u| = {value:.3g}")
    assert np.array_equal(Corners(data), Corners(states[-1])) and not data["ngdgc"]["smooth"]


def test_states_on_different_meshes_are_not_blended():
    """Each has its own elements, which the labels count; those of load steps on one mesh do not."""
    meshes = [example_4_2.Main(n=n) for n in (2, 3)]
    page = Animation(meshes).Page()
    data = Given(page)["ngdgc"]
    assert [len(Corners(state)) for state in data["states"]] == [8, 18]
    assert [label.split(", ")[1] for label in data["labels"]] == ["8 elements", "18 elements"]
    assert "if (!smooth) scene.setRenderData(states[t]);" in page
    assert "elements" not in Given(Animation([meshes[0], meshes[0]]).Page())["ngdgc"]["labels"][0]


def test_solids_are_drawn_by_their_surface():
    problem = ContactProblem(HookeMaterial(E=1000, nu=0.3), Foundation("bottom", NormalCompliance(100)),
                             dirichlet={"top": CF((0.05, 0.02, -0.02))})
    solution = NestedNewtonSolver().Solve(Discretization(problem, InteriorPenalty(), BoxMesh(2), order=1))
    corners = Corners(Given(Scene(solution, scale=2).Page()))
    top = corners[np.all(corners[..., 2] > 0.9, axis=1)]
    # Nitsche's method meets the prescribed displacement up to a jump; half the scale would be off by 0.05.
    assert len(top) == 8 and np.abs(top[..., :3].min(axis=(0, 1)) - (0.1, 0.04, 0.96)).max() < 0.02


def test_a_notebook_shows_the_page_in_a_frame(ip, steps, tmp_path):
    """The frame holds the very page that `Write` writes, escaped so that its quotes do not end the attribute."""
    for scene in (Scene(ip), Animation(steps)):
        (frame,) = re.findall(r'<iframe srcdoc="([^"]*)" [^>]*height: 400px[^>]*></iframe>', scene._repr_html_())
        assert html.unescape(frame) == scene.Write(tmp_path / "page.html").read_text(encoding="utf-8")
    assert '"' in Scene(ip).Page() and "IP, order 1, 32 elements" in Scene(ip).Page()
    assert WriteHTML(ip, tmp_path / "same.html").read_text() == Scene(ip).Page()
    assert repr(Animation(steps, scale=2)) == "Animation(3 solutions, scale=2)" and "ContactSolution" in repr(Scene(ip))


def test_a_solution_that_is_none_says_so(steps):
    assert "NOT CONVERGED" not in Scene(steps[0]).Page()
    lost = NestedNewtonSolver().Solve(steps[0].disc)
    lost.converged = False
    assert "NOT CONVERGED" in Scene(lost).Page()


def test_solutions_that_make_no_animation_are_refused(ip, steps):
    second = example_4_2.Main(n=2, order=2, method=Conforming())
    with pytest.raises(ProblemError, match=r"one dimension and order; given are 2 with .* \[\(2, 1\), \(2, 2\)\]"):
        Animation([ip, second])
    with pytest.raises(ProblemError, match="given are 0 with .* none"):
        Animation([])
    assert len(Given(Animation([ip]).Page())["ngdgc"]["states"]) == 1


def test_a_scene_has_the_colours_of_its_field(ip):
    """By name or as a function: stresses are those inside each element; of a solid its surface, from inside the elements."""
    middles = Middles(ip)
    stress = np.array([ip.stress(ip.disc.mesh(*middle)) for middle in middles]).reshape(-1, 2, 2)
    for field, expected in (("sxy", stress[:, 0, 1]), (ip.gfu[1], [ip.At(*middle)[1] for middle in middles])):
        data = Given(Scene(ip, field=field).Page())
        values = Corners(data)[..., 3].mean(axis=1)
        assert np.abs(values - expected).max() < 10 * SINGLE * np.abs(expected).max()
        assert data["funcmin"] < 0 or np.min(expected) >= 0
    assert "von Mises stress [stress]" in Scene(ip, field="vonmises").Page() and "|u| [length]" in Scene(ip).Page()
    assert "max von Mises stress" in Animation([ip], field="vonmises").Page()
    foundation = Foundation("bottom", NormalCompliance(10))
    problem = ContactProblem(HookeMaterial(E=10, nu=0), foundation, dirichlet={"top": (0, 0, -0.1)})
    pressed = Discretization(problem, InteriorPenalty(), BoxMesh(1)).Solve()
    corners = Corners(Given(Scene(pressed, field="szz").Page()))
    # Two springs in a row, of stiffness 10 each.
    assert len(corners) == 12 and np.abs(corners[..., 3] + 0.5).max() < 1e-5
