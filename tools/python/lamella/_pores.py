"""The pores of an image."""

from __future__ import annotations

from . import _arrays
from ._errors import run
from ._samples import ImageBase
from ._settings import Settings, declared
from ._solve import as_image
from ._types import Array, Columns, Image, Progress
from .vtkLamellaFilters import vtkPoreFloodFill


class PoreFloodFillResult(ImageBase):
    """``vtk`` is the image with ``pore`` and ``pore_size``; sizes are in pixels or voxels."""

    def __init__(self, image, pores, distribution) -> None:
        super().__init__(image)
        #: vtkTable, one row a pore
        self.vtk_pores = pores
        #: vtkTable, one row a class of sizes
        self.vtk_distribution = distribution

    @property
    def labels(self) -> Array:
        """Number of each pixel's pore, 0 outside, in the order of pictures (a view, no copy)."""
        return self.array("pore")

    @property
    def sizes(self) -> Array:
        """Size of each pixel's pore, NaN outside (a view, no copy)."""
        return self.array("pore_size")

    @property
    def table(self) -> Columns:
        """Columns by name, one entry a pore: ``pore``, ``size``, ``area`` or ``volume`` [m^2, m^3],
        ``equivalent_diameter`` [m], ``centre_x`` ... [m], ``x_first``, ``x_last`` ..., ``touches_x_min`` ...,
        ``percolates_x`` ... Axes are those of the data: of a picture, y points up.
        """
        return _arrays.columns(self.vtk_pores)

    @property
    def distribution(self) -> Columns:
        """Columns by name, one entry a class of sizes, each class reaching twice as far as the one before."""
        return _arrays.columns(self.vtk_distribution)

    @property
    def phase(self) -> str:
        """Name of the phase that the pores are."""
        return _arrays.text(self.vtk, "pore_phase")

    @property
    def count(self) -> int:
        """Number of pores."""
        return int(self._number("pore_count"))

    @property
    def total(self) -> int:
        """Size of all pores together."""
        return int(self._number("pore_total"))

    @property
    def mean(self) -> float:
        """Mean size."""
        return self._number("pore_mean")

    @property
    def largest(self) -> int:
        """Size of the largest pore."""
        return int(self._number("pore_largest"))

    @property
    def porosity(self) -> float:
        """Share of the phase, pores below the minimum size included."""
        return self._number("porosity")

    @property
    def dropped(self) -> tuple[int, ...]:
        """Number and total size of the pores below the minimum size."""
        return tuple(int(value) for value in _arrays.numbers(self.vtk, "pore_dropped"))

    @property
    def open_share(self) -> float:
        """Share of the total that is open: touches a border that is not periodic, or percolates."""
        return self._number("pore_open")

    @property
    def percolates(self) -> str:
        """Axes along which some pore leads from side to side, as "xy"."""
        found = _arrays.numbers(self.vtk, "pore_percolates")
        return "".join(axis for axis, flag in zip("xyz", found) if flag)

    def __repr__(self) -> str:
        return f"<lamella.PoreFloodFillResult: {self.count} pores, mean {self.mean:.1f}, largest {self.largest}>"


@declared(vtkPoreFloodFill, first=("phase", "connectivity", "periodic", "minimum_size", "sort_by_size"), without=("labels", "pore_size"))
def pore_flood_fill(sample: Image, settings: Settings, progress: Progress | None = None) -> PoreFloodFillResult:
    """Labels the connected pores of one phase of a Sample, an array of whole numbers or an image.

    sample          a Sample, an array of whole numbers or an image
    progress        called as progress(share, text); return False to cancel (raises Cancelled)
    """
    fill = vtkPoreFloodFill()
    fill.SetInputData(as_image(sample))
    settings.give(fill)
    run(fill, progress)
    return PoreFloodFillResult(fill.GetOutput(), fill.GetPores(), fill.GetSizeDistribution())
