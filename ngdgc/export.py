"""Files of a solution for other viewers: a web page with NGSolve's viewer, and VTK for ParaView."""

from pathlib import Path

import numpy as np
from ngsolve import CF, BoundaryFromVolumeCF, InnerProduct, Norm, Trace, VTKOutput, sqrt
from ngsolve.webgui import Draw

from .elasticity import HookeMaterial
from .facets import Coordinates, VolumePoints

CAMERA_ORDER = 4    # of the quadrature whose points the camera takes into view
CAPTION_STYLE = "position:fixed; left:0; right:0; bottom:8px; text-align:center; font:15px sans-serif; pointer-events:none"
LIGHT = {"ambient": 0.6, "diffuse": 0.4}
SUBDIVISION = 3     # bisections of an element in VTK files at most: 8 intervals along an edge


def WriteHTML(solution, path, *, scale=1):
    """Write one HTML file with the deformed body, coloured by |u| [length], that opens without a network.

    scale : the deformation is drawn at `scale` times the displacement, 1 is real; a slider in the page changes it

    The elements move with their own one-sided displacements, so the jumps of a DG solution show.  Returns the Path.
    """
    from webgui_jupyter_widgets.html import GenerateHTML

    disc = solution.disc
    if disc.mesh.dim == 3:
        # On the boundary NGSolve evaluates a discontinuous function to garbage unless it is asked for its volume trace.
        displacement, view = BoundaryFromVolumeCF(solution.gfu), {"draw_vol": False, "euler_angles": [-70, 0, -25]}
    else:
        displacement, view = CF(solution.gfu), {}
    # The norm as a scalar: of a vector the viewer would take the range of its first component for the colours.
    # The outline of the body would be displaced by such boundary values; the lines of the mesh are right.
    settings = {"Objects": {"Edges": False}, "Light": LIGHT}
    scene = Draw(Norm(displacement), disc.mesh, "|u|", deformation=displacement, scale=scale, settings=settings, show=False,
                 order=max(disc.order, disc.mesh.GetCurveOrder()), **_Camera(solution, scale), **view)
    caption = (f"Displacement |u| [length], deformation drawn x {scale:g} "
               f"({disc.method.name}, order {disc.order}, {disc.mesh.ne} elements)")
    head, end, tail = GenerateHTML(scene.GetData()).replace("NGSolve WebGUI", "ngdgc: displacement", 1).rpartition("</body>")
    path = Path(path)
    path.write_text(f'{head}<div style="{CAPTION_STYLE}">{caption}</div>{end}{tail}', encoding="utf-8")
    return path


def _Camera(solution, scale):
    """Centre and radius of the view; NGSolve's own frame only the undeformed body."""
    points = VolumePoints(solution.disc.mesh, CAMERA_ORDER)
    x = np.asarray(Coordinates(solution.disc.mesh.dim)(points))
    x = np.concatenate([x, x + scale * np.asarray(solution.gfu(points))])
    lower, upper = x.min(axis=0), x.max(axis=0)
    centre = np.zeros(3)
    centre[:x.shape[1]] = (lower + upper) / 2
    return {"center": centre.tolist(), "radius": 0.65 * float(np.linalg.norm(upper - lower))}


def WriteVTK(solution, path):
    """Write a VTK file (.vtu) with every element's own points, so that the jumps of a DG solution are kept.

    Fields at the points: `displacement`, 3 components (0, in 2D, appended) [length], ready for ParaView's WarpByVector;
    `stress`, the 9 components row by row [stress], and `vonmises` [stress], both with the out-of-plane stress of the plane
    state.  Elements are bisected order - 1 times, as VTK draws linearly.  `path` with or without its suffix; returns the Path
    of the file.
    """
    disc = solution.disc
    path = Path(path)
    if path.suffix != ".vtu":
        path = path.with_name(path.name + ".vtu")
    path.touch()        # VTKOutput is silent if it cannot write
    displacement = CF(tuple(solution.gfu)) if disc.mesh.dim == 3 else CF((solution.gfu[0], solution.gfu[1], 0))
    stress = SpatialStress(solution)
    bisections = min(max(disc.order, disc.mesh.GetCurveOrder()) - 1, SUBDIVISION)
    VTKOutput(disc.mesh, [displacement, stress, VonMises(stress)], ["displacement", "stress", "vonmises"],
              str(path.with_suffix("")), subdivision=bisections, legacy=False).Do()
    return path


def SpatialStress(solution):
    """C eps(u_h) as a CoefficientFunction (3, 3) [stress].

    In 2D the out-of-plane component is that of the material: lam tr(eps) in plane strain, 0 in plane stress, and 0 for an
    AnisotropicMaterial, whose plane matrix does not tell.
    """
    stress, material = solution.stress, solution.disc.problem.material
    if solution.disc.mesh.dim == 3:
        return stress
    strained = isinstance(material, HookeMaterial) and material.plane == "strain"
    normal = material.lam * Trace(solution.strain) if strained else CF(0)
    return CF((stress[0, 0], stress[0, 1], 0, stress[1, 0], stress[1, 1], 0, 0, 0, normal), dims=(3, 3))


def VonMises(stress):
    """sqrt(3/2 s:s) with the deviator s = sigma - tr(sigma)/3 I, for sigma of shape (3, 3) [stress]."""
    return sqrt(1.5 * InnerProduct(stress, stress) - 0.5 * Trace(stress)**2)
