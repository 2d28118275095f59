"""What a compression run tells: its curve, and which cells gave way."""

from __future__ import annotations

import numpy as np
from vtkmodules.vtkCommonCore import vtkDoubleArray
from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkTable
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm

from . import _arrays
from ._arrays import told
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

    table: Columns = told(
        "Columns by name: ``strain``, ``stress``, ``absorbed_energy`` [J/m^3], ``efficiency``, "
        "``smooth_stress`` [Pa].", "vtk")
    stiffness: float | None = told("Slope of the fitted line [Pa].", "curve_stiffness")
    stiffness_error: float | None = told("Standard error of the slope [Pa].", "curve_stiffness_error")
    intercept: float | None = told("Stress of the fitted line at no strain [Pa].", "curve_intercept")
    r2: float | None = told("Share of the variance that the fitted line explains.", "curve_r2")
    toe: float | None = told("Strain at which the fitted line begins.", "curve_toe")
    fit_range: tuple[float, float] | None = told(
        "Strains of the first and the last row that were fitted.", "curve_fit_range", by="_range")
    yield_point: tuple[float, float] | None = told(
        "Strain and stress [Pa] where the curve meets the fitted line moved by the offset.", "yield", by="_point")
    peak: tuple[float, float] | None = told("Strain and stress [Pa] of the first maximum.", by="_point")

    def _point(self, name):
        strain = self._number(f"curve_{name}_strain")
        return None if strain is None else (strain, self._number(f"curve_{name}_stress"))

    plateau_stress: float | None = told("Mean stress of the plateau [Pa].", "curve_plateau_stress")
    plateau_range: tuple[float, float] | None = told(
        "Strains between which that mean was taken.", "curve_plateau_range", by="_range")
    plateau_end: float | None = told(
        "Strain at which the stress is 1.3 times the plateau's.", "curve_plateau_end_strain")
    densification: float | None = told(
        "Strain at which densification begins: the efficiency of energy absorption is largest.",
        "curve_densification_strain")
    densification_stress: float | None = told("Stress there [Pa].", "curve_densification_stress")
    densification_energy: float | None = told("Energy absorbed up to there [J/m^3].", "curve_densification_energy")
    efficiency: float | None = told(
        "The largest efficiency: energy absorbed over the stress.", "curve_densification_efficiency")
    energy: float | None = told("Energy absorbed by all of the curve [J/m^3].", "curve_energy")
    missing: list[str] = told("What was not found, and why: a list of texts.", "curve_missing")

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

    labels: Array = told(
        "Number of each pixel's lumen, 0 in walls, in the order of pictures (a view, no copy).", "lumen")
    ratio: Array = told(
        "Area (volume) of each pixel's lumen in the last state over that at the start; NaN in walls (a view).",
        "lumen_ratio")
    collapse_strain: Array = told(
        "Strain at which each pixel's lumen collapsed; NaN in walls and where it did not (a view).")
    table: Columns = told(
        "Columns by name, one entry a lumen: those of ``lamella.pore_flood_fill``, ``cut``, ``ratio``, "
        "``collapse_strain``.", "vtk_lumens")
    states: Columns = told(
        "Columns by name, one entry a state: ``strain``, ``collapsed``, ``collapsed_share``, ``ratio``.", "vtk_states")
    count: int = told("Number of lumens.", "lumen_count")
    collapsed: int = told("Number of lumens that collapsed.", "lumen_collapsed")

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
