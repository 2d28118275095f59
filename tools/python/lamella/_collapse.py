"""What a compression run tells: its curve, and which cells gave way."""

from __future__ import annotations

import numpy as np
from vtkmodules.vtkCommonCore import vtkDoubleArray
from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkTable
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm

from . import _arrays
from ._errors import run
from ._samples import ImageBase
from ._settings import Settings, declared
from ._solve import as_image
from ._types import Array, ArrayLike, Columns, Image, Progress, Sequence
from .vtkLamellaFilters import vtkCollapseMap, vtkCompressionCurve


class CompressionCurveResult(_arrays.FieldData):
    """Numbers of vtkCompressionCurve: strains are fractions, compression positive. What was not found is None."""

    def __init__(self, table) -> None:
        #: vtkTable, one row a row of the curve
        self.vtk = table

    def _number(self, name):
        value = float(_arrays.numbers(self.vtk, name)[0])
        return None if np.isnan(value) else value

    @property
    def table(self) -> Columns:
        """Columns by name: ``strain``, ``stress``, ``absorbed_energy`` [J/m^3], ``efficiency``, ``smooth_stress`` [Pa]."""
        return _arrays.columns(self.vtk)

    @property
    def stiffness(self) -> float | None:
        """Slope of the fitted line [Pa]."""
        return self._number("curve_stiffness")

    @property
    def stiffness_error(self) -> float | None:
        """Standard error of the slope [Pa]."""
        return self._number("curve_stiffness_error")

    @property
    def intercept(self) -> float | None:
        """Stress of the fitted line at no strain [Pa]."""
        return self._number("curve_intercept")

    @property
    def r2(self) -> float | None:
        """Share of the variance that the fitted line explains."""
        return self._number("curve_r2")

    @property
    def toe(self) -> float | None:
        """Strain at which the fitted line begins."""
        return self._number("curve_toe")

    @property
    def fit_range(self) -> tuple[float, float] | None:
        """Strains of the first and the last row that were fitted."""
        low, high = _arrays.numbers(self.vtk, "curve_fit_range")
        return None if np.isnan(low) else (float(low), float(high))

    @property
    def yield_point(self) -> tuple[float, float] | None:
        """Strain and stress [Pa] where the curve meets the fitted line moved by the offset."""
        return self._point("yield")

    @property
    def peak(self) -> tuple[float, float] | None:
        """Strain and stress [Pa] of the first maximum."""
        return self._point("peak")

    def _point(self, name):
        strain = self._number(f"curve_{name}_strain")
        return None if strain is None else (strain, self._number(f"curve_{name}_stress"))

    @property
    def plateau_stress(self) -> float | None:
        """Mean stress of the plateau [Pa]."""
        return self._number("curve_plateau_stress")

    @property
    def plateau_range(self) -> tuple[float, float] | None:
        """Strains between which that mean was taken."""
        low, high = _arrays.numbers(self.vtk, "curve_plateau_range")
        return None if np.isnan(low) else (float(low), float(high))

    @property
    def plateau_end(self) -> float | None:
        """Strain at which the stress is 1.3 times the plateau's."""
        return self._number("curve_plateau_end_strain")

    @property
    def densification(self) -> float | None:
        """Strain at which densification begins: the efficiency of energy absorption is largest."""
        return self._number("curve_densification_strain")

    @property
    def densification_stress(self) -> float | None:
        """Stress there [Pa]."""
        return self._number("curve_densification_stress")

    @property
    def densification_energy(self) -> float | None:
        """Energy absorbed up to there [J/m^3]."""
        return self._number("curve_densification_energy")

    @property
    def efficiency(self) -> float | None:
        """The largest efficiency: energy absorbed over the stress."""
        return self._number("curve_densification_efficiency")

    @property
    def energy(self) -> float | None:
        """Energy absorbed by all of the curve [J/m^3]."""
        return self._number("curve_energy")

    @property
    def missing(self) -> list[str]:
        """What was not found, and why: a list of texts."""
        return _arrays.texts(self.vtk, "curve_missing")

    def __repr__(self) -> str:
        def shown(value, unit=""):
            return "none" if value is None else f"{value:.4g}{unit}"

        return (
            f"<lamella.CompressionCurveResult: stiffness {shown(self.stiffness, ' Pa')}, "
            f"plateau {shown(self.plateau_stress, ' Pa')}, densification at {shown(self.densification)}>"
        )


@declared(vtkCompressionCurve)
def compression_curve(strain: ArrayLike, stress: ArrayLike, settings: Settings) -> CompressionCurveResult:
    """Stiffness, collapse, plateau, densification and energy of a stress-strain curve in compression.

    strain, stress  columns of equal length: fractions, rising from row to row; Pa. Compression is positive
    """
    table = vtkTable()
    columns = {name: _arrays.reals(column, name) for name, column in (("strain", strain), ("stress", stress))}
    shapes = [column.shape for column in columns.values()]
    if len(shapes[0]) != 1 or shapes[0] != shapes[1]:
        raise ValueError(f"strain and stress have the shapes {shapes[0]} and {shapes[1]}; give two columns")
    for name, column in columns.items():
        table.AddColumn(_arrays.to_vtk(column, name))
    curve = vtkCompressionCurve()
    curve.SetInputData(table)
    settings.give(curve)
    run(curve)
    return CompressionCurveResult(curve.GetOutput())


class CollapseMapResult(ImageBase):
    """``vtk`` is the image with ``lumen``, ``lumen_ratio`` and ``collapse_strain``."""

    def __init__(self, collapse) -> None:
        super().__init__(collapse.GetOutput())
        #: vtkTable, one row a lumen
        self.vtk_lumens = collapse.GetLumenTable()
        #: vtkTable, one row a state
        self.vtk_states = collapse.GetStateTable()

    @property
    def labels(self) -> Array:
        """Number of each pixel's lumen, 0 in walls, in the order of pictures (a view, no copy)."""
        return self.array("lumen")

    @property
    def ratio(self) -> Array:
        """Area (volume) of each pixel's lumen in the last state over that at the start; NaN in walls (a view)."""
        return self.array("lumen_ratio")

    @property
    def collapse_strain(self) -> Array:
        """Strain at which each pixel's lumen collapsed; NaN in walls and where it did not (a view)."""
        return self.array("collapse_strain")

    @property
    def table(self) -> Columns:
        """Columns by name, one entry a lumen: those of ``lamella.pore_flood_fill``, ``cut``, ``ratio``,
        ``collapse_strain``.
        """
        return _arrays.columns(self.vtk_lumens)

    @property
    def states(self) -> Columns:
        """Columns by name, one entry a state: ``strain``, ``collapsed``, ``collapsed_share``, ``ratio``."""
        return _arrays.columns(self.vtk_states)

    @property
    def count(self) -> int:
        """Number of lumens."""
        return int(self._number("lumen_count"))

    @property
    def collapsed(self) -> int:
        """Number of lumens that collapsed."""
        return int(self._number("lumen_collapsed"))

    @property
    def first_strain(self) -> float | None:
        """Strain at which the first lumen collapsed; None where none did."""
        value = self._number("first_collapse_strain")
        return None if np.isnan(value) else value

    def __repr__(self) -> str:
        return f"<lamella.CollapseMapResult: {self.collapsed} of {self.count} lumens collapsed>"


def _with_strain(points, strain):
    state = vtkPolyData()
    state.ShallowCopy(points)
    array = vtkDoubleArray()
    array.SetName("strain")
    array.InsertNextValue(float(strain))
    state.GetFieldData().AddArray(array)
    return state


@declared(vtkCollapseMap)
def collapse_map(
    sample: Image,
    points: vtkPolyData | Sequence[vtkPolyData] | vtkAlgorithm,
    strains: ArrayLike | None = None,
    settings: Settings | None = None,
    progress: Progress | None = None,
) -> CollapseMapResult:
    """Which cells of a tissue give way in compression, and at which strain.

    sample          the Sample, image or array of phases that the points were made from
    points          a vtkPolyData a state, with the arrays ``id`` and ``deformation_gradient``, a list of them, or a
                    vtkAlgorithm that offers them as time steps
    strains         one a state, rising; None: the field data ``strain`` of each, or the times of an algorithm
    progress        called as progress(share, text); return False to cancel (raises Cancelled)
    """
    collapse = vtkCollapseMap()
    collapse.SetInputData(as_image(sample))
    if isinstance(points, vtkAlgorithm):
        if strains is not None:
            raise TypeError("strains go with data, not with an algorithm, which has times")
        collapse.SetPointsConnection(points.GetOutputPort())
    else:
        states = [points] if isinstance(points, vtkPolyData) else list(points)
        if strains is not None:
            strains = np.atleast_1d(strains)
            if len(strains) != len(states):
                raise ValueError(f"{len(strains)} strains for {len(states)} states; give one each")
            states = [_with_strain(state, strain) for state, strain in zip(states, strains)]
        if not states:
            raise ValueError("points is an empty list; give one state at least")
        for state in states:
            collapse.AddPointsData(state)
    settings.give(collapse)
    run(collapse, progress)
    return CollapseMapResult(collapse)
