"""Heat and water vapour through a piece of wood, in both directions, through ParaView's filters; no display needed.

    export PYTHONPATH=build/python
    pvpython examples/diffusion/diffusion.py
    mpirun -n 2 pvbatch examples/diffusion/diffusion.py
    pvpython examples/diffusion/diffusion.py --picture wood.png --phase 0=lumen --phase 255=wall --pixel-size 5e-7

Makes the tissue (or reads --picture), computes, prints the effective conductivities between their bounds, and writes to --output:
  heat.vti, vapour.vti (or .pvti)   fields of both directions, for ParaView
  heat.vtp, vapour.vtp (or .pvtp)   streamlines
  heat.png, vapour.png              where the flux goes
"""

import argparse
import math
import os

import lamella  # before the first view: lets ParaView draw with no display

from paraview.simple import *  # noqa: F403

lamella.load_plugin(globals())

# Conductivities relative to the better conductor: cell wall and air (lumen).
PROBLEMS = {
    "heat": {"Quantity": "Temperature", "Conductivities": ["wall", "1", "lumen", "0.023"]},
    "vapour": {"Quantity": "Concentration", "Conductivities": ["wall", "0.004", "lumen", "1"]},
}


def numbers(source, name):
    """Numbers of a field array; the same on every rank, so rank 0's will do."""
    array = servermanager.Fetch(source).GetFieldData().GetArray(name)  # noqa: F405
    return [array.GetTuple1(i) for i in range(array.GetNumberOfTuples())]


def draw(flux, title, path):
    """The magnitude of the flux with streamlines that each carry the same share of it."""
    x0, x1, y0, y1, _, _ = flux.GetDataInformation().GetBounds()
    width, margin, below = 1200, 40, 110  # pixels
    scale = (x1 - x0) / (width - 2 * margin)  # metres a pixel
    height = int((y1 - y0) / scale) + 2 * margin + below
    view = CreateView("RenderView")  # noqa: F405
    view.ViewSize = [width, height]
    view.UseColorPaletteForBackground = 0
    view.Background = [1, 1, 1]
    view.OrientationAxesVisibility = 0
    view.InteractionMode = "2D"
    centre = [(x0 + x1) / 2, (y0 + y1) / 2 - below / 2 * scale]
    view.CameraFocalPoint = [*centre, 0]
    view.CameraPosition = [*centre, x1 - x0]
    view.CameraParallelProjection = 1
    view.CameraParallelScale = height * scale / 2

    shown = Show(OutputPort(flux, 0), view)  # noqa: F405
    shown.Representation = "Slice"
    ColorBy(shown, ("POINTS", "flux_magnitude"))  # noqa: F405
    colours = GetColorTransferFunction("flux_magnitude")  # noqa: F405
    colours.ApplyPreset("Viridis (matplotlib)", True)
    colours.AutomaticRescaleRangeMode = "Never"
    # A few corners carry many times the mean: they would leave the rest dark.
    mean = abs(numbers(flux, "mean_flux")[4])
    top = min(flux.PointData["flux_magnitude"].GetRange()[1], 5 * mean)
    step = 10 ** math.floor(math.log10(top)) / 2
    colours.RescaleTransferFunction(0, math.ceil(top / step) * step)
    legend = GetScalarBar(colours, view)  # noqa: F405
    legend.Title = title
    legend.ComponentTitle = ""
    legend.TitleColor = legend.LabelColor = [0.1, 0.1, 0.1]
    legend.Orientation = "Horizontal"
    legend.RangeLabelFormat = legend.LabelFormat = "%g"
    legend.WindowLocation = "Any Location"
    legend.Position = [0.25, 0.25 * below / height]
    legend.ScalarBarLength = 0.5
    shown.SetScalarBarVisibility(view, True)

    lines = Show(OutputPort(flux, 1), view)  # noqa: F405
    ColorBy(lines, None)  # noqa: F405
    lines.AmbientColor = lines.DiffuseColor = [1, 1, 1]
    lines.LineWidth = 2
    # As tubes, which are made of areas, in their own colour: of plain lines Mesa leaves out every pixel in whose very
    # centre two segments meet, and all lines bend where they cross a row of nodes.
    lines.RenderLinesAsTubes = 1
    lines.Ambient, lines.Diffuse, lines.Specular = 1, 0, 0
    # towards the camera: in the map's own plane they would be drawn in part only; ParaView 5.13 has a new name for it
    lines.SetPropertyWithName("Translation" if "Translation" in lines.ListProperties() else "Position", [0, 0, scale])
    SaveScreenshot(path, view)  # noqa: F405
    Delete(view)  # noqa: F405


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--size", type=int, nargs=2, default=[600, 400], help="nodes along x and y [600 400]")
    parser.add_argument("--solid-fraction", type=float, default=0.40, help="share of the cell walls [0.40]")
    parser.add_argument("--seed", type=int, default=2016, help="another seed, another piece of wood [2016]")
    parser.add_argument("--picture", help="compute this label picture instead of a generated tissue")
    parser.add_argument("--phase", action="append", metavar="GREY=NAME", help="a grey of the picture: lumen or wall")
    parser.add_argument("--pixel-size", type=float, help="edge of a pixel of the picture in metres")
    parser.add_argument("--output", default="results/diffusion", help="folder [results/diffusion]")
    options = parser.parse_args()
    os.makedirs(options.output, exist_ok=True)

    if options.picture:
        phases = options.phase or ["0=lumen", "255=wall"]
        tissue = PictureReader(  # noqa: F405
            FileName=options.picture, Phases=[word for phase in phases for word in phase.split("=", 1)]
        )
        if options.pixel_size:
            tissue.PixelSize = options.pixel_size
    else:
        tissue = MicrostructureSource(  # noqa: F405
            Size=[*options.size, 1], SolidFraction=options.solid_fraction, Seed=options.seed, RingPosition=[0, 1]
        )
    parts = servermanager.vtkProcessModule.GetProcessModule().GetNumberOfLocalPartitions()  # noqa: F405
    prefix = "p" if parts > 1 else ""
    rows = []
    for name, problem in PROBLEMS.items():
        solved = SteadyDiffusion(Input=tissue, Direction="All", **problem)  # noqa: F405
        flux = FluxMap(Input=solved, Direction="y")  # noqa: F405
        flux.UpdatePipeline()
        k = numbers(flux, "effective_conductivity")
        tortuosity = numbers(flux, "tortuosity")
        rows.append((name, k[0], k[4], *numbers(flux, "bounds"), tortuosity[0], tortuosity[1]))
        SaveData(os.path.join(options.output, f"{name}.{prefix}vti"), proxy=flux)  # noqa: F405
        SaveData(os.path.join(options.output, f"{name}.{prefix}vtp"), proxy=OutputPort(flux, 1))  # noqa: F405
        draw(flux, f"flux of {name}, conductivity/m", os.path.join(options.output, f"{name}.png"))

    head = ("", "k_x", "k_y", "series", "HS lower", "HS upper", "parallel", "tort. x", "tort. y")
    print("  ".join(f"{word:>9}" for word in head))
    for name, *values in rows:
        print(f"{name:>9}  " + "  ".join(f"{value:9.5f}" for value in values))
        series, parallel = values[2], values[5]
        assert all(series <= k <= parallel for k in values[:2]), "a conductivity outside its bounds"
    print("series and parallel bound every material of these phases; Hashin and Shtrikman (HS) isotropic media alone, and wood is none")
    print(f"x radial, y tangential; {parts} process(es); files in {options.output}")


if __name__ == "__main__":
    main()
