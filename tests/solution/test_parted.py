"""What several processes have saved, put in order: contact points come as the mesh has them."""

import numpy as np

from ngdgc import LDG, ContactProblem, Discretization, Foundation, HookeMaterial, NormalCompliance
from ngdgc.meshes import RectangleMesh
from ngdgc.solution.parts import Ordered


def test_points_of_a_folder_come_in_the_order_of_the_mesh():
    """Each foundation by itself, whatever the order in which processes had them; equal to the last bit."""
    foundations = [Foundation(side, NormalCompliance(1)) for side in ("bottom", "left")]
    problem = ContactProblem(HookeMaterial(E=1, nu=0.3), foundations, dirichlet={"top": (0, 0)})
    contact = Discretization(problem, LDG(), RectangleMesh(3)).contact
    rng, n = np.random.default_rng(1), len(contact.weights)
    mixed = np.concatenate([rng.permutation(np.arange(part.points.start, part.points.stop)) for part in contact.parts])
    right = {"points": contact.coordinates, "traction": rng.random((n, 2)), "slip": rng.random(n),
             "laws": rng.random((5, n, 1))}
    arrays = {name: array[:, mixed] if name == "laws" else array[mixed] for name, array in right.items()}
    found = Ordered("here", contact, {**arrays, "vector": rng.random(n), "history": np.zeros((0, 5)), "energies": np.ones(1)})
    assert all(np.array_equal(found[name], array) for name, array in right.items())
    assert not np.array_equal(arrays["traction"], right["traction"])
