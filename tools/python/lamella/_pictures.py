"""Pictures fit for a paper, with no display."""

from __future__ import annotations

from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkPolyData

from . import _files
from ._errors import LamellaError
from ._samples import ImageBase
from ._solve import as_image
from ._types import ArrayLike, HasImage, Path, Sequence

try:
    from .vtkLamellaRendering import vtkSnapshot
except ModuleNotFoundError:
    vtkSnapshot = None


def snapshot(
    data: HasImage | vtkDataObject | ArrayLike,
    path: Path,
    preset: str = "auto",
    array: str | None = None,
    title: str | None = None,
    size: Sequence[int] | None = None,
    value_range: Sequence[float] | None = None,
    color_map: str | None = None,
    overlay: str = "auto",
    overlay_array: str | None = None,
    lines: vtkPolyData | None = None,
    background: Sequence[float] = (1, 1, 1),
    transparent: bool = False,
    overwrite: bool = False,
) -> str:
    """Draws a Sample, a result or a VTK data object into a PNG.

    data         what to draw
    path, overwrite  the file; one that is there already is only replaced where overwrite is True
    preset       "auto", "phase", "temperature", "concentration", "flux", "grain", "pores", "stress" or "scalar"
    array        the array to draw; None: the preset's own
    size         (width, height) in pixels; None: follows from the data
    value_range  values at the ends of the colour map
    color_map    viridis, inferno, magma, cividis, gray, coolwarm or blue-red; None: the preset's
    overlay      "auto", "none", "lines", "arrows" or "isolines"
    overlay_array  the vectors that lines and arrows follow; None: the array drawn, or "flux"
    lines        streamlines (vtkPolyData) to draw instead of those that it finds
    title        above the picture; None: none
    background, transparent  colour (red, green, blue), 0 to 1 each; or none at all
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
    path = _files.new_path(path, overwrite)
    if not drawing.Write(path) or errors:
        raise LamellaError(drawing.GetErrorMessage(), drawing.GetErrorHint())
    return path
