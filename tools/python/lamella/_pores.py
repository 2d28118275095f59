"""The pores of an image."""

from __future__ import annotations

from . import _arrays
from ._arrays import told
from ._samples import ImageBase
from ._settings import Settings, declared
from ._solve import run_on
from ._types import Array, Columns, Image, Progress
from ._windows import WindowErrors
from .vtkLamellaFilters import vtkPoreFloodFill


class PoreFloodFillResult(WindowErrors, ImageBase):
    """``vtk`` is the image with ``pore`` and ``pore_size``; sizes are in pixels or voxels."""

    def __init__(self, image, pores, distribution) -> None:
        super().__init__(image)
        #: vtkTable, one row a pore
        self.vtk_pores = pores
        #: vtkTable, one row a class of sizes
        self.vtk_distribution = distribution

    labels: Array = told("Number of each pixel's pore, 0 outside, in the order of pictures (a view, no copy).", "pore")
    sizes: Array = told("Size of each pixel's pore, NaN outside (a view, no copy).", "pore_size")
    table: Columns = told(
        "Columns by name, one entry a pore: ``pore``, ``size``, ``area`` or ``volume`` [m^2, m^3], "
        "``equivalent_diameter`` [m], ``centre_x`` ... [m], ``x_first``, ``x_last`` ..., ``touches_x_min`` ..., "
        "``percolates_x`` ... Axes are those of the data: of a picture, y points up.", "vtk_pores")
    distribution: Columns = told(
        "Columns by name, one entry a class of sizes, each class reaching twice as far as the one before.",
        "vtk_distribution")
    phase: str = told("Name of the phase that the pores are.", "pore_phase")
    count: int = told("Number of pores.", "pore_count")
    total: int = told("Size of all pores together.", "pore_total")
    mean: float = told("Mean size.", "pore_mean")
    largest: int = told("Size of the largest pore.", "pore_largest")
    porosity: float = told("Share of the phase, pores below the minimum size included.")

    @property
    def dropped(self) -> tuple[int, ...]:
        """Number and total size of the pores below the minimum size."""
        return tuple(int(value) for value in _arrays.numbers(self.vtk, "pore_dropped"))

    open_share: float = told(
        "Share of the total that is open: touches a border that is not periodic, or percolates.", "pore_open")
    percolates: str = told(
        'Axes along which some pore leads from side to side, as "xy".', "pore_percolates", by="_axes")

    def __repr__(self) -> str:
        return f"<lamella.PoreFloodFillResult: {self.count} pores, mean {self.mean:.1f}, largest {self.largest}>"


@declared(vtkPoreFloodFill, first=("phase", "connectivity", "periodic", "minimum_size", "sort_by_size"), without=("labels", "pore_size"))
def pore_flood_fill(sample: Image, settings: Settings, progress: Progress | None = None) -> PoreFloodFillResult:
    """Labels the connected pores of one phase of a Sample, an array of whole numbers or an image.

    sample          a Sample, an array of whole numbers or an image
    """
    fill = run_on(sample, vtkPoreFloodFill(), settings, progress)
    return PoreFloodFillResult(fill.GetOutput(), fill.GetPores(), fill.GetSizeDistribution())
