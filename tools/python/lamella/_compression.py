"""Material points: compression to densification, and stiffness without time."""

from __future__ import annotations


import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkTable

from . import _arrays, _files
from ._arrays import told
from ._errors import choose, number, run
from ._runs import LoadedState, LongRun, check_checkpoint
from ._settings import Settings, declared
from ._solve import as_image, run_on
from ._types import Array, Columns, Image, OnStep, Path, Progress
from .vtkLamellaSolversVTK import vtkPointCompression, vtkPointStiffness

_FIELDS = {name: name for name in ("displacement", "velocity", "stress", "deformation_gradient", "energy_density")}


class PointState(LoadedState, _arrays.Answer):
    """The points at one strain: ``vtk`` is the vtkPolyData. Points stand in the order of their numbers."""

    def __init__(self, points) -> None:
        #: the vtkPolyData
        self.vtk = points

    @property
    def positions(self) -> Array:
        """x, y, z of every point [m], n by 3 (a view)."""
        return vtk_to_numpy(self.vtk.GetPoints().GetData())

    def array(self, name: str) -> Array:
        """An array of the points: "id", "phase", "displacement" [m] and what was asked for: "velocity" [m/s], "stress" [Pa]
        (Cauchy's: xx, yy, zz, xy, yz, xz), "deformation_gradient" (9, by rows), "energy_density" [J/m^3],
        "plastic_strain" (equivalent; of walls that yield) (a view)."""
        found = self.vtk.GetPointData().GetArray(name)
        if found is None:
            raise KeyError(f"the points have no array {name!r}; ask for it with fields=")
        return vtk_to_numpy(found)

    def save(self, path: Path, overwrite: bool = False) -> str:
        """Writes the points as a .vtp file, whole or not at all."""
        return _files.save_poly_data(self.vtk, path, overwrite)

    def __repr__(self) -> str:
        return f"<lamella.PointState: strain {self.imposed_strain:.6g}, {self.vtk.GetNumberOfPoints()} points>"


class CompressionResult(LongRun, _arrays.Answer):
    """``vtk`` is the vtkPolyData at the end with all numbers as field data; ``vtk_curve`` a vtkTable.

    Strains and stresses are positive in compression. Energies of a picture are per metre of thickness. y points up.
    """

    def __init__(self, algorithm) -> None:
        points = [algorithm.GetStatePoints(i) for i in range(algorithm.GetNumberOfStates())]
        #: a state for each strain asked for, and the end
        self.states = [PointState(state) for state in points]
        #: the points at the end
        self.vtk = points[-1]
        #: a row at even strains
        self.vtk_curve = vtkTable()
        self.vtk_curve.ShallowCopy(algorithm.GetCurve())

    curve: Columns = told(
        "All columns of the curve, a dictionary of arrays: strain, stress, imbalance, lateral_stress, "
        "lateral_strain, porosity, elastic_energy, kinetic_energy, work, dissipated, plastic_work, speed, steps, time (SI).",
        "vtk_curve")
    strain: Array = told("Curve: 1 - H/H0 [1].", by="_column")
    stress: Array = told(
        "Curve: force on the platens over the section at the start [Pa], means over half a row before and "
        "after.", by="_column")

    @property
    def points(self) -> PointState:
        """The points at the end, a PointState."""
        return self.states[-1]

    energy_ratio: float = told(
        "The largest kinetic over elastic energy beyond ``calm_from``: how quasi-static it was.", "worst_energy_ratio")

    @property
    def quality(self) -> dict[str, float]:
        """How far to trust the curve beyond ``calm_from``: worst "energy_ratio" (at "energy_ratio_strain"), "lateral" and
        "imbalance" stress over the axial one; "slowdowns" of the platens; "first_touch_strain"."""
        names = ("worst_energy_ratio", "worst_energy_ratio_strain", "worst_lateral", "worst_imbalance", "first_touch_strain")
        found = {name.removeprefix("worst_"): self._number(name) for name in names}
        found["slowdowns"] = self._count("slowdowns")
        return found

    @property
    def statistics(self) -> dict[str, float]:
        """"points", "bytes_per_point", "steps", "updates_per_second" (of points, wall time), "setup_seconds", "run_seconds"."""
        counts = {name: self._count(name) for name in ("points", "steps", "updates_per_second")}
        seconds = _arrays.numbers(self.vtk, "seconds")
        return {**counts, "bytes_per_point": self._number("bytes_per_point"), "setup_seconds": float(seconds[0]),
                "run_seconds": float(seconds[1])}

    axis: str = told('Axis of loading: "x", "y" or "z".', "load_axis")

    def save(self, path: Path, overwrite: bool = False) -> str:
        """Writes the points at the end as a .vtp file, whole or not at all."""
        return self.points.save(path, overwrite)

    def save_curve(self, path: Path, overwrite: bool = False) -> str:
        """Writes the curve as comma-separated values, whole or not at all."""
        path = _files.new_path(path, overwrite)
        curve = self.curve
        lines = [",".join(curve), *(",".join(map(repr, map(float, row))) for row in zip(*curve.values()))]
        _files.write_bytes(("\n".join(lines) + "\n").encode("utf-8"), path)
        return path

    def __repr__(self) -> str:
        return (
            f"<lamella.CompressionResult: stress {self.stress[-1]:.6g} Pa at a strain of {self.strain[-1]:.4g}, "
            f"{self.vtk.GetNumberOfPoints()} points, kinetic energy at most {100 * self.energy_ratio:.2g} % of the elastic>"
        )


class PointStiffnessResult(_arrays.Answer):
    """``vtk`` is the vtkTable of constants with all numbers as field data; ``vtk_tensor`` that of the tensor."""

    def __init__(self, constants, tensor) -> None:
        #: one row a constant
        self.vtk = constants
        #: one row a stress
        self.vtk_tensor = tensor

    @property
    def constants(self) -> dict[str, float]:
        """Moduli [Pa] and Poisson's ratios by name: E_x, nu_xy ..."""
        return dict(zip(_arrays.texts(self.vtk, "constant_names"), map(float, _arrays.numbers(self.vtk, "constants"))))

    components: list[str] = told("Names of the tensor's rows and columns.", "stiffness_components")

    @property
    def stiffness(self) -> Array:
        """The tensor [Pa], of the strains that the sides allow; empty for open sides."""
        n = len(self.components)
        return _arrays.numbers(self.vtk, "stiffness").reshape(n, n)

    @property
    def statistics(self) -> dict[str, float]:
        """"points", "nodes", "iterations", "residual", "setup_seconds", "solve_seconds"."""
        seconds = _arrays.numbers(self.vtk, "seconds")
        counts = {name: self._count(name) for name in ("points", "nodes", "iterations")}
        return {**counts, "residual": self._number("residual"), "setup_seconds": float(seconds[0]),
                "solve_seconds": float(seconds[1])}

    def __repr__(self) -> str:
        numbers = ", ".join(f"{name} {value:.6g}" for name, value in self.constants.items() if name[0] == "E")
        return f"<lamella.PointStiffnessResult: {numbers} Pa>"


def _check_points(settings):
    """Moduli and densities are above 0, which the classes take for "not given"."""
    for name in ("young", "transverse", "shear", "density"):
        value = settings.values.get(name)
        for phase, one in value.items() if hasattr(value, "items") else [] if value is None else [(None, value)]:
            of = "" if phase is None else f" of {phase!r}"
            if not number(one, name + of) > 0:
                raise ValueError(f"{name}{of} is {one!r}; it is above 0, or None")


@declared(vtkPointCompression, first=("axis", "strain", "sides"), without=("phase_constant", "keep_states", "state"), formerly={
    "speeds": lambda three: dict(zip(("first_speed", "least_speed", "most_speed"), three)),
    "fields": lambda names: {**dict.fromkeys(_FIELDS, False), **{choose(_FIELDS, name, "a field"): True for name in np.atleast_1d(names)}}})
def compression(
    image: Image, settings: Settings, progress: Progress | None = None, on_step: OnStep | None = None
) -> CompressionResult:
    """Presses a sample between platens, slowly, and returns a CompressionResult.

    image           a Sample, a vtkImageData with the point array ``phase``, or an array of whole numbers; with the point
                    array ``axis`` walls are orthotropic along it
    on_step         called as on_step(state) with each PointState that the run comes to; memory then holds one at a time, and
                    the result has the last one only

    Constants of walls are numbers, or {phase: number}. Where points_per_node is not given there are two a cell, and two at
    least; 3 where walls fold, beyond some 20 % strain. A checkpoint that is there already is only replaced where
    continue_from names it too.
    """
    solve = vtkPointCompression()
    solve.SetInputData(as_image(image))
    check_checkpoint(settings)
    _check_points(settings)
    settings.give(solve)
    run(solve, progress, on_step, PointState)
    return CompressionResult(solve)


@declared(vtkPointStiffness, first=("sides",), without=("phase_constant",))
def point_stiffness(image: Image, settings: Settings, progress: Progress | None = None) -> PointStiffnessResult:
    """Stiffness of a sample by an implicit solve, along every axis; returns a PointStiffnessResult.

    image           as compression() takes it, and so are constants of walls
    """
    _check_points(settings)
    solve = run_on(image, vtkPointStiffness(), settings, progress)
    return PointStiffnessResult(solve.GetConstants(), solve.GetTensor())
