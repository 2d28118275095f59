"""Material points: compression to densification, and stiffness without time."""

from __future__ import annotations

import math

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkTable

from . import _arrays, _files
from ._errors import check_keywords, choose, entries, number, run
from ._runs import LoadedState, LongRun, set_checkpoint
from ._solve import as_image
from ._types import Any, Array, ArrayLike, Columns, Image, OnStep, Path, Progress, Sequence
from .vtkLamellaSolversVTK import vtkPointCompression, vtkPointStiffness

_AXES = {None: -1, "x": 0, "y": 1, "z": 2}
_LAWS = {None: 0, "isotropic": 1, "orthotropic": 2, "plastic": 3}
_PLANES = {None: 0, "plane-stress": 1, "plane-strain": 2}
_SIDES = {"straight": 0, "open": 1, "fixed": 2, "periodic": 3}
_SHAPES = {"linear": 0, "gimp": 1, "spline": 2}
_TRANSFERS = {"flip": 0, "pic": 1, "apic": 2, "xpic": 3}
_FIELDS = {
    "displacement": "ComputeDisplacement",
    "velocity": "ComputeVelocity",
    "stress": "ComputeStress",
    "deformation_gradient": "ComputeDeformationGradient",
    "energy_density": "ComputeEnergyDensity",
}


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
        (Cauchy's: xx, yy, zz, xy, yz, xz), "deformation_gradient" (9, by rows), "energy_density" [J/m^3] (a view)."""
        found = self.vtk.GetPointData().GetArray(name)
        if found is None:
            raise KeyError(f"the points have no array {name!r}; ask for it with fields=")
        return vtk_to_numpy(found)

    def save(self, path: Path, overwrite: bool = False) -> str:
        """Writes the points as a .vtp file, whole or not at all."""
        path = _files.new_path(path, overwrite)
        _files.write_poly_data(self.vtk, path)
        return path

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

    @property
    def curve(self) -> Columns:
        """All columns of the curve, a dictionary of arrays: strain, stress, imbalance, lateral_stress, lateral_strain, porosity,
        elastic_energy, kinetic_energy, work, dissipated, speed, steps, time (SI)."""
        return _arrays.columns(self.vtk_curve)

    @property
    def strain(self) -> Array:
        """Curve: 1 - H/H0 [1]."""
        return vtk_to_numpy(self.vtk_curve.GetColumnByName("strain"))

    @property
    def stress(self) -> Array:
        """Curve: force on the platens over the section at the start [Pa], means over half a row before and after."""
        return vtk_to_numpy(self.vtk_curve.GetColumnByName("stress"))

    @property
    def points(self) -> PointState:
        """The points at the end, a PointState."""
        return self.states[-1]

    @property
    def energy_ratio(self) -> float:
        """The largest kinetic over elastic energy beyond ``calm_from``: how quasi-static it was."""
        return self._number("worst_energy_ratio")

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

    @property
    def axis(self) -> str:
        """Axis of loading: "x", "y" or "z"."""
        return _arrays.text(self.vtk, "load_axis")

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

    @property
    def components(self) -> list[str]:
        """Names of the tensor's rows and columns."""
        return _arrays.texts(self.vtk, "stiffness_components")

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


def _positive(value, name, of=""):
    """A constant of a wall; moduli and densities are above 0, which VTK's setters take for "not given"."""
    found = number(value, name + of)
    if name in ("young", "transverse", "shear", "density") and not found > 0:
        raise ValueError(f"{name}{of} is {value!r}; it is above 0, or None")
    return found


def _set_points(
    algorithm,
    law=None,
    plane=None,
    young=None,
    transverse=None,
    poisson=None,
    transverse_poisson=None,
    shear=None,
    barrier=None,
    yield_stress=None,
    hardening=None,
    density=None,
    void=None,
    points_per_node=None,
    cells_per_node=1.0,
    fit_platens=False,
    threads=1,
):
    """Settings of vtkPointAlgorithm; see compression()."""
    algorithm.SetLaw(choose(_LAWS, law, "law"))
    algorithm.SetPlane(choose(_PLANES, plane, "plane"))
    constants = (
        (algorithm.SetYoungsModulus, "young", young),
        (algorithm.SetTransverseModulus, "transverse", transverse),
        (algorithm.SetPoissonsRatio, "poisson", poisson),
        (algorithm.SetTransversePoissonsRatio, "transverse-poisson", transverse_poisson),
        (algorithm.SetShearModulus, "shear", shear),
        (algorithm.SetBarrier, "barrier", barrier),
        (algorithm.SetYieldStress, "yield", yield_stress),
        (algorithm.SetHardening, "hardening", hardening),
        (algorithm.SetDensity, "density", density),
    )
    for setter, name, value in constants:
        if np.isscalar(value):
            setter(_positive(value, name))
            continue
        for phase, constant in entries(value, name, "{phase: value}, or a number"):
            algorithm.SetPhaseConstant(str(phase), name, _positive(constant, name, f" of {phase!r}"))
    for name in [void] if isinstance(void, (str, int)) else (void or ()):
        algorithm.AddVoid(str(name))
    algorithm.SetPointsPerNode(max(2, math.ceil(2 * float(cells_per_node))) if points_per_node is None else int(points_per_node))
    algorithm.SetCellsPerNode(float(cells_per_node))
    algorithm.SetFitPlatens(bool(fit_platens))
    algorithm.SetThreads(int(threads))


def compression(
    image: Image,
    axis: str | None = None,
    strain: float = 0.48,
    sides: str = "straight",
    grip: bool = False,
    energy_ratio: float = 0.01,
    calm_from: float = 0.05,
    speeds: Sequence[float] = (1e-3, 5e-5, 2e-2),
    damping: float = 0.0,
    rows: int = 240,
    at_strains: ArrayLike = (),
    fields: str | Sequence[str] = ("displacement",),
    shape: str = "spline",
    transfer: str = "apic",
    consistent_mass: bool = False,
    modified_update: bool = False,
    time_step: float | None = None,
    checkpoint: Path | None = None,
    checkpoint_every: int = 2000,
    continue_from: Path | None = None,
    progress: Progress | None = None,
    on_step: OnStep | None = None,
    **points: Any,
) -> CompressionResult:
    """Presses a sample between platens, slowly, and returns a CompressionResult.

    image     a Sample, a vtkImageData with the point array ``phase``, or an array of whole numbers; with the point array
              ``axis`` walls are orthotropic along it
    axis      None: y of a picture, z of a volume
    strain    to end at, above 0 and below 1
    sides     across the load: "straight" (they move so that the force on them is nothing), "open", "fixed", "periodic"
    grip      platens do not let slide
    energy_ratio, calm_from  kinetic over elastic energy allowed from this strain on
    speeds    of the platens towards each other, over the fastest wave in the wall: first, least, most
    damping   friction against an even deformation, over the lowest frequency of a bar of wall as high as the specimen
    rows      of the curve
    at_strains  states to keep; the end is always kept
    fields    of the states: "displacement", "velocity", "stress", "deformation_gradient", "energy_density"; besides "id"
              and "phase", which they always have
    shape     "linear", "gimp", "spline"
    transfer  "flip", "pic", "apic", "xpic"
    consistent_mass, modified_update  see vtkPointCompression
    time_step  seconds; None: 0.9 of the largest stable one
    checkpoint, checkpoint_every, continue_from  as fracture() takes them; checkpoint_every in steps
    progress  called as progress(share, text); return False to cancel (raises Cancelled)
    on_step   called as on_step(state) with each PointState that the run comes to; memory then holds one at a time, and the
              result has the last one only

    Of the points:
    law       "isotropic", "orthotropic", "plastic"; None: orthotropic where the image has ``axis``, else isotropic
    plane     "plane-stress", "plane-strain"; None: plane stress, plane strain of walls that yield
    young, transverse, poisson, transverse_poisson, shear, barrier, yield_stress, hardening, density  of all walls, or
              {phase: value}, SI units; None: those of vtkPointAlgorithm
    void      phases without points; None: those called void, pore, lumen, air or 0
    points_per_node  along each axis in a pixel; None: two a cell, and two at least; 3 where walls fold, beyond some 20 %
              strain
    cells_per_node  of the grid, along each axis in a pixel
    fit_platens  platens stand where the tissue begins and ends, not at the ends of the image
    threads   0: all cores
    """
    check_keywords(compression, _set_points, points)
    solve = vtkPointCompression()
    solve.SetInputData(as_image(image))
    _set_points(solve, **points)
    solve.SetLoadAxis(choose(_AXES, axis, "axis"))
    solve.SetStrain(float(strain))
    solve.SetSides(choose(_SIDES, sides, "sides"))
    solve.SetGrip(bool(grip))
    solve.SetEnergyRatio(float(energy_ratio))
    solve.SetCalmFrom(float(calm_from))
    first, least, most = (float(speed) for speed in speeds)
    solve.SetFirstSpeed(first)
    solve.SetLeastSpeed(least)
    solve.SetMostSpeed(most)
    solve.SetDamping(float(damping))
    solve.SetRows(int(rows))
    for value in np.ravel(at_strains):
        solve.AddStateAtStrain(float(value))
    wanted = [choose(_FIELDS, name, "a field") for name in ([fields] if isinstance(fields, str) else fields)]
    for setting in _FIELDS.values():
        getattr(solve, "Set" + setting)(setting in wanted)
    solve.SetShape(choose(_SHAPES, shape, "shape"))
    solve.SetTransfer(choose(_TRANSFERS, transfer, "transfer"))
    solve.SetConsistentMass(bool(consistent_mass))
    solve.SetModifiedUpdate(bool(modified_update))
    solve.SetTimeStep(0.0 if time_step is None else float(time_step))
    set_checkpoint(solve, checkpoint, checkpoint_every, continue_from)
    run(solve, progress, on_step, PointState)
    return CompressionResult(solve)


def point_stiffness(
    image: Image,
    sides: str = "straight",
    tolerance: float = 1e-6,
    max_iterations: int = 20000,
    progress: Progress | None = None,
    **points: Any,
) -> PointStiffnessResult:
    """Stiffness of a sample by an implicit solve, along every axis; returns a PointStiffnessResult.

    image     as compression() takes it, and so are the keywords of the points
    sides     "straight" (platens on one axis, the others straight and without force), "open", "fixed", "periodic" (the
              whole tensor) or "sticky" (an upper bound of it)
    tolerance, max_iterations  largest residual; gives up after so many iterations
    progress  called as progress(share, text); return False to cancel (raises Cancelled)
    """
    check_keywords(point_stiffness, _set_points, points)
    solve = vtkPointStiffness()
    solve.SetInputData(as_image(image))
    _set_points(solve, **points)
    solve.SetSides(choose({**_SIDES, "sticky": 4}, sides, "sides"))
    solve.SetTolerance(float(tolerance))
    solve.SetMaximumIterations(int(max_iterations))
    run(solve, progress)
    return PointStiffnessResult(solve.GetConstants(), solve.GetTensor())
