"""Spheres cemented in three dimensions, pulled until they fail, and the crack's surface drawn by ParaView with no display.

    PYTHONPATH=build/python pvpython examples/cemented-grains/volume.py

The strain is raised in steps; all critical bonds break at once (batched), one equilibrium a batch; grains are four times as stiff and
as tough as the matrix. Writes to --output: volume.vti (the end: phases, grains, damage), volume.vtp (broken bonds), volume.csv (stress and strain),
volume-grains.vtp and volume.png (half of the grains, and in red the surface within which nodes have lost a tenth of their bonds or
more). With --checkpoint a run that was stopped goes on where its file stands.
"""

import argparse
import os
import time

import lamella
import numpy as np
from ends import without_ends
from paraview.simple import (
    Calculator, Contour, CreateView, GetActiveCamera, OpenDataFile, Outline, Render, SaveScreenshot, Show,
)
from vtkmodules.vtkCommonDataModel import vtkPlane, vtkPlaneCollection
from vtkmodules.vtkFiltersCore import vtkAppendPolyData, vtkPolyDataNormals
from vtkmodules.vtkFiltersGeneral import vtkClipClosedSurface
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

YOUNG, RATIO, CRITICAL = 1e9, 4, 1e-3


def torn(packing, options):
    whole = lamella.bridges(packing, width=0.7, nodes_across=options.nodes)
    image = without_ends(whole, options.cut * 2 * float(np.mean(packing.radii)))
    young = dict.fromkeys(("matrix", "matrix-grain", "grain-grain"), YOUNG)
    young["grain"] = RATIO * YOUNG
    last = [0.0]

    def progress(share, text):
        if time.monotonic() - last[0] > 10:
            last[0] = time.monotonic()
            print(f"\r{100 * share:.0f} % {text}", end="", flush=True)
        return True

    return lamella.fracture(image, young, critical_stretch=dict.fromkeys(young, CRITICAL), horizon=options.horizon, method="accurate",
                            breaking="batched", strain_step=options.step * CRITICAL, stop=options.stop, tolerance=options.tolerance,
                            checkpoint=options.checkpoint, continue_from=options.checkpoint, checkpoint_every=50,
                            threads=options.threads, displacement=False, progress=progress)


def spheres(packing, bounds, path):
    """The grains behind a plane through the middle, as a file of surfaces, cut where the sample ends."""
    centres, radii = np.asarray(packing.centres), np.asarray(packing.radii)
    middle = centres.mean(axis=0)
    together = vtkAppendPolyData()
    for centre, radius in zip(centres, radii):
        if np.dot(centre - middle, [-0.4, 1, 0]) > 0:
            sphere = vtkSphereSource()
            sphere.SetRadius(radius)
            sphere.SetThetaResolution(48)
            sphere.SetPhiResolution(32)
            sphere.SetCenter(*centre)
            together.AddInputConnection(sphere.GetOutputPort())
    ends = vtkPlaneCollection()
    for place, direction in ((bounds[4], 1), (bounds[5], -1)):
        plane = vtkPlane()
        plane.SetOrigin(0, 0, place)
        plane.SetNormal(0, 0, direction)
        ends.AddItem(plane)
    cut = vtkClipClosedSurface()
    cut.SetInputConnection(together.GetOutputPort())
    cut.SetClippingPlanes(ends)
    smooth = vtkPolyDataNormals()
    smooth.SetInputConnection(cut.GetOutputPort())
    smooth.SetFeatureAngle(40)
    writer = vtkXMLPolyDataWriter()
    writer.SetFileName(path)
    writer.SetInputConnection(smooth.GetOutputPort())
    writer.Write()


def draw(file, grains, path, damage=0.1):
    view = CreateView("RenderView")
    view.ViewSize = [1000, 1000]
    view.Background = [1, 1, 1]
    view.UseColorPaletteForBackground = 0
    view.OrientationAxesVisibility = 0
    sample = OpenDataFile(file)
    bounds = np.reshape(sample.GetDataInformation().GetBounds(), (3, 2))
    whole = Calculator(Input=sample, ResultArrayName="damage", Function="if(damage > 0, damage, 0)")  # NaN in voids has no surface
    crack = Contour(Input=whole, ContourBy=["POINTS", "damage"], Isosurfaces=[damage])
    for what, colour in ((OpenDataFile(grains), [0.66, 0.70, 0.76]), (crack, [0.82, 0.11, 0.11]), (Outline(Input=sample), [0.2, 0.2, 0.2])):
        shown = Show(what, view)
        shown.ColorArrayName = [None, ""]
        shown.DiffuseColor = shown.AmbientColor = colour
    camera, middle, size = GetActiveCamera(), bounds.mean(axis=1), float(np.linalg.norm(bounds[:, 1] - bounds[:, 0]))
    camera.SetFocalPoint(*middle)
    camera.SetPosition(*(middle + size * np.array([0.75, -1.6, 0.5])))
    camera.SetViewUp(0, 0, 1)
    camera.SetViewAngle(31)
    Render(view)
    SaveScreenshot(path, view)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", default="results/cemented-grains", help="folder (default: %(default)s)")
    parser.add_argument("--nodes", type=int, default=100, help="nodes across (default: %(default)s)")
    parser.add_argument("--count", type=int, default=250, help="spheres (default: %(default)s)")
    parser.add_argument("--cut", type=float, default=0.5, help="off both ends, in mean diameters, for the platens to hold grains (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--horizon", type=float, default=2, help="spacings (default: %(default)s)")
    parser.add_argument("--step", type=float, default=0.05, help="of the strain, over that at which bonds break (default: %(default)s)")
    parser.add_argument("--stop", type=float, default=0.2, help="share of the peak at which the sample has failed (default: %(default)s)")
    parser.add_argument("--checkpoint", help="file that keeps where the run stands, and from which it goes on")
    parser.add_argument("--tolerance", type=float, default=1e-4, help="of an equilibrium (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    options = parser.parse_args()
    os.makedirs(options.output, exist_ok=True)
    file = os.path.join(options.output, "volume.vti")
    begun = time.perf_counter()
    packing = lamella.packing(count=options.count, dimension=3, aspect=1.2, seed=options.seed)
    result = torn(packing, options)
    result.save(file, overwrite=True)
    result.save_broken(os.path.join(options.output, "volume.vtp"), overwrite=True)
    np.savetxt(os.path.join(options.output, "volume.csv"), np.column_stack([result.strain, result.stress]), delimiter=",",
               header="strain,stress [Pa]", comments="")
    wide, deep, high = result.vtk.GetDimensions()
    print(f"\n{wide} x {deep} x {high} nodes: strength {result.peak_stress:.4g} Pa, {len(result.broken)} bonds broken in "
          f"{result.statistics['events']} batches, {time.perf_counter() - begun:.0f} s; {result.end}")
    grains = os.path.join(options.output, "volume-grains.vtp")
    spheres(packing, result.vtk.GetBounds(), grains)
    draw(file, grains, os.path.join(options.output, "volume.png"))


if __name__ == "__main__":
    main()
