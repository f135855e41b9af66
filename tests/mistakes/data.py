"""Mistakes in the data of a problem, as in `mistakes`: numbers, vectors, regions and materials."""

import numpy as np
from mistakes import Disc, On
from netgen.geom2d import SplineGeometry
from ngsolve import CF, H1, CacheCF, Grad, GridFunction, IfPos, Mesh, SurfaceL2, VectorH1, sqrt, x, y
from problems import Example

from ngdgc import (LDG, AnisotropicMaterial, Conforming, ContactProblem, CoulombFriction, Discretization, HookeMaterial,
                   NormalCompliance, TrescaFriction)
from ngdgc.meshes import BoxMesh, RectangleMesh

NAN = sqrt(-1 - x)
SQUARE = RectangleMesh(2)
SURFACE = GridFunction(SurfaceL2(SQUARE, order=1))
SURFACE.Set(0.01, definedon=SQUARE.Boundaries(".*"))
SKIN = GridFunction(H1(SQUARE, definedon=SQUARE.Boundaries(".*")))
NOWHERE = GridFunction(H1(SQUARE, definedon=SQUARE.Materials("elsewhere")))


def TwoMaterials(Within=lambda modulus: modulus, Material=lambda modulus: HookeMaterial(E=modulus, nu=0.3)):
    """A modulus for one of two materials, on its own or within an expression."""
    geometry = SplineGeometry()
    geometry.AddRectangle((0, 0), (1, 1), bcs=["bottom", "right", "top", "left"], leftdomain=1)
    geometry.AddRectangle((0.3, 0.3), (0.7, 0.7), leftdomain=2, rightdomain=1)
    geometry.SetMaterial(1, "steel")
    geometry.SetMaterial(2, "rubber")
    mesh = Mesh(geometry.GenerateMesh(maxh=0.4))
    return Disc(mesh=mesh, material=Material(Within(mesh.MaterialCF({"steel": 2000}))))


DATA = [
    # Numbers, vectors and regions.
    (lambda _: NormalCompliance(float("inf")), "stiffness is inf | finite number or a CoefficientFunction | give"),
    (lambda _: NormalCompliance("soft"), "stiffness is 'soft' | a number or a scalar CoefficientFunction | give"),
    (lambda _: TrescaFriction(CF(1j)), "bound is complex | a real CoefficientFunction | give"),
    (lambda _: On(gap=CF((0, 0))), "gap has 2 components | a scalar | give"),
    (lambda _: Example(dirichlet={"right": 0}), "dirichlet['right'] is 0 | one component per dimension | give a vector"),
    (lambda _: Example(dirichlet={"right": (None, 0)}),
     "component 1 of dirichlet['right'] is None | a number or a scalar CoefficientFunction | give"),
    (lambda _: Example(bodyforce=CF((1j, 0))), "bodyforce is complex | a real CoefficientFunction | give"),
    (lambda _: Example(traction={"[": CF((0, 0))}),
     "traction region is '[' | a regular expression such as 'left|right' | give"),
    (lambda _: Disc(foundation=On(gap=H1(RectangleMesh(1)).TrialFunction())),
     "gap cannot be evaluated | that has values there | give a number or a CoefficientFunction"),
    (lambda _: Disc(bodyforce=VectorH1(RectangleMesh(1)).TrialFunction()),
     "bodyforce cannot be evaluated | that has values there | give a number or a CoefficientFunction"),
    (lambda _: Disc(foundation=On(gap=NAN)), "gap is not finite | division by zero or a root of a negative number | look for"),
    # Boundary data that have no values there, or none that the element inside could see.
    (lambda _: Disc(mesh=SQUARE, foundation=On(gap=SQUARE.BoundaryCF({"left": 0.01}))),
     "gap has no value on boundary 'bottom' | or a default | give one"),
    (lambda _: Disc(mesh=SQUARE, foundation=On(gap=NOWHERE)),
     "gap contains a GridFunction | not defined on all of the boundary | give one of a space on all elements"),
    (lambda _: Disc(mesh=SQUARE, foundation=On(gap=Grad(SKIN)[0])),
     "gap contains a GridFunction of H1, or its derivative | no values in the elements | give one of a space on elements"),
    (lambda _: Disc(mesh=SQUARE, foundation=On(gap=CacheCF(SURFACE))),
     "gap contains a function with values on boundary elements only | values in the elements | give one"),
    (lambda _: Disc(mesh=SQUARE, foundation=On(gap=2 * (SURFACE * x).Compile())),
     "gap combines functions of the boundary | sums, products and IfPos | write it with"),
    (lambda _: TwoMaterials(),
     "E is 0 in material 'rubber' | MaterialCF has neither value nor default | must be greater than 0"),
    (lambda _: TwoMaterials(lambda modulus: 1 + modulus), "E has no value on material 'rubber' | or a default | give one"),
    (lambda _: HookeMaterial(E=0, nu=0.3), "E is 0 | greater than 0 | must be"),
    (lambda _: CoulombFriction(-0.1), "coefficient is -0.1 | at least 0 | must be"),
    # Materials.
    (lambda _: HookeMaterial(E=1, nu=0.3, plane="both"), "plane='both' | 'strain' or 'stress' | choose"),
    (lambda _: HookeMaterial(E=1, nu=0.5), "nu is 0.5 | less than 0.5 | must be"),
    (lambda _: HookeMaterial(E=1), "HookeMaterial got ['E'] | E and nu, or mu and lam | give"),
    (lambda _: AnisotropicMaterial(5), "voigt is 5 | 3 x 3 (2D) or 6 x 6 (3D) matrix | give"),
    (lambda _: AnisotropicMaterial([[1, 0], [0, 1]]),
     "voigt has 2 rows of lengths [2, 2] | 3 x 3 (2D) or 6 x 6 (3D) | must be"),
    (lambda _: AnisotropicMaterial([[1, 2, 0], [0, 1, 0], [0, 0, 1]]),
     "voigt is not symmetric: entries differ by 2 | C_ijkl = C_klij | give a matrix"),
    (lambda _: AnisotropicMaterial([[1, 2, 0], [2, 1, 0], [0, 0, 1]]),
     "voigt is not positive definite: its smallest eigenvalue is -1 | all must be positive | look at signs"),
    (lambda _: Example(material=AnisotropicMaterial(np.eye(6))), "material: 3 | different dimensions | give all of them"),
    (lambda _: Discretization(ContactProblem(HookeMaterial(E=1, nu=0.3, plane="stress"), On(), roller={"top": 0}),
                              LDG(), BoxMesh(1)), "plane='stress' on a mesh of dimension 3 | in 2D only | take plane='strain'"),
    (lambda _: Disc(material=HookeMaterial(mu=IfPos(0.97 - y, 1000, -1e6), lam=1000), order=5).matrix,
     "the material is not positive definite | some quadrature point | look at its sign and size everywhere"),
    (lambda _: Disc(Conforming(), material=HookeMaterial(E=1000 + sqrt(0.97 - y), nu=0.3), order=5).matrix,
     "the material is not finite | some quadrature point | look for a division by zero"),
    (lambda _: Disc(material=HookeMaterial(E=1000 + sqrt((x - 0.5) ** 2 - 1e-10), nu=0.3)).matrix,
     "the material is not finite | some quadrature point | look for a division by zero")]
