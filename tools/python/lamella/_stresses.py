"""How stresses are distributed."""

from __future__ import annotations

from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkDataSet

from . import _arrays
from ._arrays import told
from ._errors import run
from ._samples import ImageBase
from ._settings import Settings, declared
from ._types import Columns, HasImage, Progress
from .vtkLamellaFilters import vtkStressPDF


class StressPDFResult(_arrays.FieldData):
    """Tables of vtkStressPDF; stresses of the density are in mean tensile stresses."""

    def __init__(self, density, phases, thresholds) -> None:
        #: vtkTable, one row a bin
        self.vtk = density
        #: vtkTable, one row for all, then one a phase
        self.vtk_phases = phases
        #: vtkTable, one row a threshold
        self.vtk_thresholds = thresholds

    density: Columns = told(
        "Columns by name, one entry a bin: ``stress`` (its middle), ``stress_low``, ``stress_high``, ``count``, "
        "``density``, ``tail`` (the law that was fitted), ``count_<phase>``, ``density_<phase>``.", "vtk")

    @property
    def phases(self) -> dict[str, dict[str, float]]:
        """By name of the phase, and for ``"all"``: ``count``, ``mean``, ``deviation``, ``mean_tensile``,
        ``mean_compressive``, ``smallest``, ``largest`` [Pa], ``tensile_share``, ``compressive_share``, ``tail_count``,
        ``theta``, ``theta_error``; with a reference stress ``mean_tensile_over_reference`` and
        ``mean_compressive_over_reference``.
        """
        columns = _arrays.columns(self.vtk_phases)
        names = columns.pop("phase")
        return {name: {key: column[row].item() for key, column in columns.items()} for row, name in enumerate(names)}

    thresholds: Columns = told(
        "Columns by name, one entry a threshold: ``threshold``, ``tail_count``, ``tail_share``, ``theta``, "
        "``theta_error``, ``distance``.", "vtk_thresholds")
    mean_tensile: float = told("Mean of the stresses above 0 [Pa].", "stress_mean_tensile")
    mean_compressive: float = told(
        "Mean of the stresses below 0 [Pa], negative; 0 where there is none.", "stress_mean_compressive")
    theta: float = told(
        "Rate of the exponential tail; NaN where fewer than two stresses are beyond the threshold.", "stress_theta")
    theta_error: float = told(
        "Standard error of ``theta`` if stresses were independent. Neighbours are alike: samples scatter more.",
        "stress_theta_error")
    threshold: float = told("Where the tail begins, in mean tensile stresses.", "stress_tail_threshold")
    distance: float = told(
        "Largest difference between the cumulative shares of the tail's stresses and of the law.",
        "stress_tail_distance")

    def __repr__(self) -> str:
        return (
            f"<lamella.StressPDFResult: mean tensile {self.mean_tensile:.4g} Pa, "
            f"theta {self.theta:.3f} beyond {self.threshold:.3g}>"
        )


@declared(vtkStressPDF, first=("component", "phases"), formerly={"keep_platens": lambda keep: {"leave_out_platens": not keep}})
def stress_pdf(
    data: HasImage | vtkDataSet,
    settings: Settings,
    array: str = "stress",
    phase_array: str = "phase",
    cells: bool = False,
    progress: Progress | None = None,
) -> StressPDFResult:
    """Probability density of a stress, mean tensile and compressive stress, and the exponential tail.

    data            a result of ``lamella.equilibrium``, or any vtkDataSet with stresses
    array, phase_array, cells   where stresses and phases are, and whether at cells
    """
    pdf = vtkStressPDF()
    if isinstance(data, ImageBase):
        data = data.vtk
    if not isinstance(data, vtkDataSet):
        raise TypeError(f"data is a {type(data).__name__}; it can be a result of lamella or a vtkDataSet")
    pdf.SetInputData(data)
    association = vtkDataObject.FIELD_ASSOCIATION_CELLS if cells else vtkDataObject.FIELD_ASSOCIATION_POINTS
    pdf.SetInputArrayToProcess(0, 0, 0, association, array)
    pdf.SetInputArrayToProcess(1, 0, 0, association, phase_array)
    settings.give(pdf)
    run(pdf, progress)
    return StressPDFResult(pdf.GetOutput(), pdf.GetPhaseTable(), pdf.GetThresholdTable())
