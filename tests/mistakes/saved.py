"""Mistakes with saved solutions, as in `mistakes`."""

import hashlib
import json

import numpy as np
from mistakes import Disc
from netgen.occ import Circle, OCCGeometry
from ngsolve import BilinearForm, GridFunction, Mesh, VectorH1, dx
from problems import Example

from ngdgc import (Conforming, ContactProblem, ContactSolution, Discretization, Foundation, HookeMaterial, InteriorPenalty,
                   NormalCompliance, Solve, TrescaFriction)
from ngdgc.meshes import RectangleMesh
from ngdgc.solution.storage import Write


def Saved(folder):
    Solve(Disc()).Save(folder)
    return folder


def Edited(folder, *, words=(), arrays=(), without=(), digests=True):
    """A saved solution with some words and arrays replaced or left out, and digests that say that this was saved."""
    text, data = folder / "solution.json", folder / "fields.npz"
    found = {key: value for key, value in {**json.loads(text.read_text()), **dict(words)}.items() if key not in without}
    with np.load(data) as fields:
        np.savez(data, **{key: value for key, value in {**fields, **dict(arrays)}.items() if key not in without})
    if digests:
        stated = {key: value for key, value in found.items() if key != "digests"}
        found["digests"] = {name: hashlib.sha256((folder / name).read_bytes()).hexdigest()
                            for name in ("mesh.vol.bin", "mesh.vol.gz", "fields.npz")}
        found["digests"]["solution.json"] = hashlib.sha256(json.dumps(stated, sort_keys=True).encode()).hexdigest()
    text.write_text(json.dumps(found))
    return folder


def NoMesh(folder):
    (Saved(folder) / "mesh.vol.gz").unlink()
    return folder


def Altered(folder, *, traction=1, inside=0):
    """A solution with another traction, or with noise inside the body, where the contact law does not see it."""
    solution = Solve(Disc())
    away = np.diff(solution.disc.contact.trace.tocsc().indptr) == 0
    noise = inside * np.random.default_rng(1).standard_normal(len(away)) * away
    ContactSolution(solution.disc, solution.vector + noise, traction * solution.traction, history=solution.history).Save(folder)
    return folder


def Deformed(folder):
    mesh = RectangleMesh(2)
    mesh.SetDeformation(GridFunction(VectorH1(mesh)))
    Solve(Disc(mesh=mesh)).Save(folder)


def CurvedBefore(folder):
    """A disc that was curved and then refined, which a Discretization refuses."""
    mesh = Mesh(OCCGeometry(Circle((0, 0), 1).Face(), dim=2).GenerateMesh(maxh=0.5))
    mesh.Curve(3)
    mesh.Refine()
    Write(folder, mesh, {}, {})


def OnRing(folder):
    """A disc on a ring of foundation, its mesh of second order."""
    shape = Circle((0, 0), 1).Face()
    shape.edges.name = "ring"
    netgen = OCCGeometry(shape, dim=2).GenerateMesh(maxh=0.5)
    netgen.SecondOrder()
    ring = Foundation("ring", NormalCompliance(1000), friction=TrescaFriction(1), gap=-0.01)
    Solve(Discretization(ContactProblem(HookeMaterial(E=100, nu=0.3), ring), InteriorPenalty(), Mesh(netgen))).Save(folder)
    return folder


class Own(InteriorPenalty):
    """A method of a user's own."""


def Added(folder, *forms):
    """What Load says of a solution with a mass, given these forms."""
    disc = Disc()
    u, v = disc.space.TnT()
    Solve(disc.Add(BilinearForm(3 * u * v * dx))).Save(folder)
    return ContactSolution.Load(folder, Example(), added=list(forms))


def OnCoarser():
    u, v = Disc(Conforming()).space.TnT()
    return BilinearForm(3 * u * v * dx)


SAVED = [
    (lambda folder: Solve(ContactSolution.Load(Saved(folder), Example()).disc),
     "a solution that was loaded | has no default solver | take NestedNewtonSolver().Solve(solution.disc)"),
    (lambda folder: ContactSolution.Load(folder, Example()),
     "holds no saved solution | ContactSolution.Save has written | give a folder"),
    (lambda folder: ContactSolution.Load(NoMesh(folder), Example()),
     "mesh.vol.gz is missing | ContactSolution.Save | give a folder"),
    (lambda folder: ContactSolution.Load(Edited(Saved(folder), words={"format": 0}), Example()),
     "has format 0 | this version reads 1 | save it anew"),
    (lambda folder: ContactSolution.Load(Saved(folder), Example(stiffness=400.0)),
     "was computed with another problem | its pressures differ | give the one it was saved with"),
    (lambda folder: ContactSolution.Load(Edited(Saved(folder), words={"converged": "no"}), Example()),
     "'converged' in solution.json is 'no' | expected is bool | save it anew"),
    (lambda folder: ContactSolution.Load(Edited(Saved(folder), without=["laws"]), Example()),
     "holds no complete solution | fields.npz has no 'laws' | save it anew"),
    (lambda folder: ContactSolution.Load(Edited(Saved(folder), words={"order": 2}, digests=False), Example()),
     "is damaged: fields.npz | is not what was saved | give a folder as ContactSolution.Save has left it"),
    (lambda folder: ContactSolution.Load(Edited(Saved(folder), words={"method": "METHODS"}), Example()),
     "was saved with method METHODS | this version has not | it knows InteriorPenalty"),
    (lambda folder: ContactSolution.Load(Edited(Saved(folder), arrays={"traction": np.full((4, 2), np.nan)}), Example()),
     "has a traction | that is not finite | solve again"),
    (lambda folder: ContactSolution.Load(Edited(Saved(folder), words={"order": 2}), Example()),
     "coefficients, and Discretization(IP, order 2 | has | give a folder as ContactSolution.Save has left it"),
    (lambda folder: ContactSolution.Load(Edited(Saved(folder), words={"summary": {"levels": 3}}), Example()),
     "the history or the summary in | is none of an iteration | give a folder as ContactSolution.Save has left it"),
    (lambda folder: ContactSolution.Load(Edited(Saved(folder), arrays={"dofs": np.zeros(3, dtype=int)}), Example()),
     "the dofs in | are none of Discretization | give a folder as ContactSolution.Save has left it"),
    (lambda folder: ContactSolution.Load(Edited(Saved(folder), arrays={"pieces": np.ones((1, 4))}), Example()),
     "the pieces in | are no parts of boundary elements | give a folder as"),
    (lambda folder: ContactSolution.Load(Edited(Saved(folder), arrays={"slip": np.ones(4)}), Example()),
     "the slip in | is not that of its coefficients | give a folder as ContactSolution.Save has left it"),
    (lambda folder: ContactSolution.Load(Altered(folder, traction=2), Example()),
     "does not obey the contact law | recorded is | solve again"),
    (lambda folder: ContactSolution.Load(Altered(folder, inside=1e-3), Example()),
     "is not in balance | of its terms | solve again"),
    (lambda folder: ContactSolution.Load(Saved(folder), Example(), added=3), "added is 3 | a list of the forms | give"),
    (lambda folder: Added(folder), "was computed with added forms | give them again | added=[...]"),
    (lambda folder: Added(folder, 3), "added[0] is 3 | a function of the space | give a form"),
    (lambda folder: Added(folder, lambda: None), "added[0] fails: TypeError | a function of the space alone | give"),
    (lambda folder: Added(folder, OnCoarser()),
     "added[0] lives on another space | the same mesh, method and order | make it on"),
    (lambda folder: Saved(Saved(folder) / "solution.json"),
     "cannot save into | a folder that can be written | give"),
    (lambda folder: Solve(Disc(Own())).Save(folder), "method is Own() | which a file cannot name | keep solution.vector"),
    (lambda folder: Deformed(folder), "the mesh has a deformation | its file does not keep | save solutions of"),
    (lambda folder: CurvedBefore(folder),
     "the mesh cannot be kept in a file | its elements lie elsewhere | curve it after"),
    (lambda folder: ContactSolution.Load(Edited(OnRing(folder), words={"ngsolve": "6.1"}), Example()),
     "has a mesh of second order | it is read by NGSolve 6.1 alone | take that, or curve a mesh instead")]
