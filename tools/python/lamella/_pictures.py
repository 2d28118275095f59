"""Pictures fit for a paper, with no display."""

import os

from ._errors import LamellaError
from ._samples import ImageBase
from ._solve import as_image

try:
    from .vtkLamellaRendering import vtkSnapshot
except ModuleNotFoundError:
    vtkSnapshot = None


def snapshot(
    data,
    path,
    preset="auto",
    array=None,
    title=None,
    size=None,
    value_range=None,
    color_map=None,
    overlay="auto",
    overlay_array=None,
    lines=None,
    background=(1, 1, 1),
    transparent=False,
    overwrite=False,
):
    """Draws a Sample, a result or a VTK data object into a PNG.

    preset       "auto", "phase", "temperature", "concentration", "flux", "grain", "pores", "stress" or "scalar"
    array        the array to draw; None: the preset's own
    size         (width, height) in pixels; None: follows from the data
    value_range  values at the ends of the colour map
    color_map    viridis, inferno, magma, cividis, gray, coolwarm or blue-red; None: the preset's
    overlay      "auto", "none", "lines", "arrows" or "isolines"
    overlay_array  the vectors that lines and arrows follow; None: the array drawn, or "flux"
    lines        streamlines (vtkPolyData) to draw instead of those that it finds
    """
    if vtkSnapshot is None:
        raise LamellaError("this build draws no pictures", "build filters/rendering as well")
    drawing = vtkSnapshot()
    errors = []
    drawing.AddObserver("ErrorEvent", lambda *_: errors.append(True))
    drawing.SetInputData(data.vtk if isinstance(data, ImageBase) else data if hasattr(data, "IsA") else as_image(data))
    if not drawing.SetPresetByName(preset):
        raise ValueError(f"preset is {preset!r}; it can be auto, phase, temperature, concentration, flux, grain, pores, stress, scalar")
    if not drawing.SetOverlayByName(overlay):
        raise ValueError(f"overlay is {overlay!r}; it can be auto, none, lines, arrows, isolines")
    if array is not None:
        drawing.SetArrayName(array)
    if overlay_array is not None:
        drawing.SetOverlayArrayName(overlay_array)
    if lines is not None:
        drawing.SetOverlayLines(lines)
    if title is not None:
        drawing.SetTitle(title)
    if size is not None:
        drawing.SetSize(*size)
    if value_range is not None:
        drawing.SetRange(*value_range)
    if color_map is not None:
        drawing.SetColorMap(color_map)
    drawing.SetBackground(*background)
    drawing.SetTransparent(bool(transparent))
    drawing.SetOverwrite(bool(overwrite))
    path = os.fspath(path)
    if not drawing.Write(path) or errors:
        raise LamellaError(drawing.GetErrorMessage(), drawing.GetErrorHint())
    return path
