"""Bonds in motion: waves, cracks that run, strength by a damped pull, with every energy accounted for."""

from __future__ import annotations

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkImageData

from . import _arrays
from ._bonds import check_names, set_bonds, set_load
from ._breaks import BreakResult, BrokenState, run_breaks
from ._errors import check_keywords, entries, number
from ._samples import ImageBase
from ._solve import as_image
from ._types import Any, Array, ArrayLike, Image, Mapping, Name, OnStep, Pairs, Path, Progress, Sequence
from .vtkLamellaSolversVTK import vtkBondDynamics

_LOADS = {"stretch": 0, "shear": 1, "sides": 0}
_ENERGIES = "kinetic elastic broken damped supplied".split()


class MotionState(BrokenState):
    """The sample at one time: ``vtk`` is the image with ``damage``, ``broken``, ``velocity`` and what was asked for."""

    @property
    def time(self) -> float:
        """Since the start [s]."""
        return self._number("time")

    @property
    def velocity(self) -> Array:
        """[m/s], x, y (and z) in the last axis (a view)."""
        return self.array("velocity")[..., : self._dimension]

    def __repr__(self) -> str:
        return f"<lamella.MotionState: {self.time:.6g} s, {self.broken_bonds} bonds broken>"


class DynamicsResult(BreakResult):
    """``vtk`` is the image at the end with all numbers as field data; ``vtk_broken`` a vtkPolyData with a vertex a
    broken bond; ``vtk_curve`` a vtkTable, the history.

    Of a pull strains and stresses are those of the platens, positive along the load; else strain is how far the two
    sides have moved apart on the mean over their distance, stress the mean over the box, along ``axis``. Energies of a
    picture are per metre of thickness. y points up.
    """

    _State = MotionState
    _KINDS = (("event", "i8", 1), ("step", "i8", 1), ("time", "f8", 1), ("energy", "f8", 1))
    _TIMES = ("bonds", "start", "motion", "states")

    @property
    def time(self) -> Array:
        """History: times [s]."""
        return self._column("time")

    @property
    def strain(self) -> Array:
        """History: strains at ``time``."""
        return self._column("strain")

    @property
    def rate(self) -> Array:
        """History: imposed speeds over what they are without regulation."""
        return self._column("rate")

    @property
    def energies(self) -> dict[str, Array]:
        """History [J]: a dictionary of "kinetic", "elastic", "broken", "damped" and "supplied"."""
        return {name: self._column(name + "_energy") for name in _ENERGIES}

    @property
    def energy_defect(self) -> Array:
        """History: what the energies miss or have too much, over the largest of them."""
        return self._column("energy_defect")

    @property
    def broken(self) -> Array:
        """The broken bonds in order, a structured array: ``event`` (from 1; those of one step share it), ``step``,
        ``time`` [s], ``energy`` that it held [J], ``position`` of the middle and ``bond`` vector (x, y (and z) [m]),
        ``phases`` of both ends (the lesser first), ``between_grains``."""
        return self._broken_bonds()

    @property
    def velocity(self) -> Array:
        """At the end: [m/s], x, y (and z) in the last axis (a view)."""
        return self.states[-1].velocity

    @property
    def steps(self) -> int:
        """How many there were."""
        return self._count("steps")

    @property
    def time_step(self) -> float:
        """Of the integration [s]."""
        return self._number("time_step")

    @property
    def stable_step(self) -> float:
        """The largest stable step [s]."""
        return self._number("stable_step")

    @property
    def strain_rate(self) -> float:
        """Of a pull [1/s]; NaN without."""
        return self._number("strain_rate")

    @property
    def travel_time(self) -> float:
        """Of a pull: of a wave from platen to platen [s]; NaN without."""
        return self._number("travel_time")

    @property
    def seconds(self) -> dict[str, float]:
        """What took how long, a dictionary."""
        return self._seconds()

    def __repr__(self) -> str:
        return (
            f"<lamella.DynamicsResult: {self.time[-1]:.6g} s in {self.steps} steps, "
            f"{self.vtk_broken.GetNumberOfPoints()} bonds broken, {self.end}>"
        )


def _each(vector, what):
    """Components that are given, as ("x", 1.0)."""
    if not 2 <= len(vector) <= 3:
        raise ValueError(f"{what} is {vector!r}; it has a number, or None, along x, y and in space z")
    return [("xyz"[c], float(value)) for c, value in enumerate(vector) if value is not None]


def _with_velocity(image, velocity):
    """A copy of the image with an array of velocities, given in the order of pictures."""
    copy = vtkImageData()
    copy.ShallowCopy(image)
    sample = ImageBase(copy)
    shape = (*sample.shape, len(sample.shape))
    sample.set_array("velocity", _arrays.reals(velocity, "velocity", shape))
    return copy


def dynamics(
    image: Image,
    young: Pairs,
    density: float | Mapping[Name, float],
    fracture_energy: Pairs | None = None,
    toughness: Pairs | None = None,
    critical_stretch: Pairs | None = None,
    load: str | None = None,
    axis: str | None = None,
    compression: bool = False,
    smooth_platens: bool = False,
    rigid_platens: bool = False,
    platen_layers: int = 0,
    strain_rate: float | None = None,
    travel_times: float = 30.0,
    start: float = 0.98,
    velocities: Mapping[str, Sequence[float | None]] | None = None,
    tractions: Mapping[str, Sequence[float | None]] | None = None,
    boxes: Sequence[tuple] = (),
    velocity: ArrayLike | None = None,
    tau: float | None = None,
    omega0: float | None = None,
    delta_l: float | None = None,
    start_rate: float = 1.0,
    damping: float = 0.0,
    step: float | None = None,
    step_share: float = 0.8,
    end_time: float | None = None,
    stop: float = 0.05,
    max_strain: float | None = None,
    max_broken: int | None = None,
    at_times: ArrayLike = (),
    at_broken: ArrayLike = (),
    history_every: int = 0,
    displacement: bool = True,
    stress: bool = False,
    strain_energy: bool = False,
    checkpoint: Path | None = None,
    checkpoint_every: int = 1000,
    continue_from: Path | None = None,
    progress: Progress | None = None,
    on_step: OnStep | None = None,
    **bonds: Any,
) -> DynamicsResult:
    """Moves a sample, breaks its bonds as they become critical, and returns a DynamicsResult.

    image, young, fracture_energy, toughness, critical_stretch  as fracture() takes them; without one of the last three
              nothing breaks
    density   [kg/m³]: a number, or {phase: number}
    load      "stretch", "shear": platens pull the sample; "sides": what is said of sides, boxes and velocities moves it;
              None: "sides" where anything is said of them, else "stretch"
    axis, compression, smooth_platens, rigid_platens  of the platens, as fracture() takes them; axis also of strain and
              stress without platens
    platen_layers  that platens and sides hold; 0: as many as a bond reaches
    strain_rate  of the platens [1/s]; None: the strain of the first break takes travel_times of a wave between them
    start     the pull begins in equilibrium at this share of the strain of the first break, with its speeds
    velocities  {side: vector}: nodes of sides "x-", "x+", "y-", "y+" (the top of a picture), "z-", "z+" keep a velocity
              [m/s]; None for a component that is free: {"x-": (5, None)}
    tractions {side: vector}: force on the area of a side [Pa]
    boxes     ((low corner, high corner, vector), ...): nodes between two corners [m] keep a velocity
    velocity  of all that is free, at the start [m/s]: a vector, or one for each node in the order of pictures
    tau, omega0, delta_l, start_rate  imposed speeds give way to what breaks, with the relaxation time tau [s]; reference
              energy omega0 [J/m], in space [J], or that of a crack of delta_l [m]; None: of a hundredth of the shortest
              side; share of the speeds at first
    damping   viscous force, as a share of the least critical viscosity of the bonds
    step      [s], refused above the largest stable one; None: step_share of that
    end_time  [s]; with platens the run ends when the stress has fallen to the share ``stop`` of its peak, at the latest
    max_strain, max_broken  other ends; None: no limit
    at_times, at_broken  states to keep: times [s], numbers of broken bonds; the end is always kept
    history_every  steps between two points of the history; 0: 500 points until end_time, at least 20
                   steps apart, else every 10 steps
    displacement, stress, strain_energy  whether states have these fields
    checkpoint, checkpoint_every, continue_from  as fracture() takes them; in steps
    progress  called as progress(share, text); return False to cancel (raises Cancelled)
    on_step   called as on_step(state) with each state that the run comes to, as ``states`` has them; memory then holds one
              at a time, and the result has the last one only

    Of the bonds' keywords it takes those of equilibrium() but strains: forces are exact for large ones.
    """
    if "strains" in bonds:
        raise TypeError("dynamics() takes no strains: its forces are exact for large ones")
    solve = vtkBondDynamics()
    sample = as_image(image)
    check_keywords(dynamics, set_bonds, bonds)
    set_bonds(solve, sample, young, fracture_energy, toughness, critical_stretch, **bonds)
    if np.isscalar(density):
        solve.SetDensity(number(density, "density"))
    else:
        given = entries(density, "density", "{phase: value}, or a number")
        check_names(sample, [str(phase) for phase, _ in given], pairs=False)
        for phase, value in given:
            solve.SetPhaseDensity(str(phase), number(value, f"density of {phase!r}"))
    sides = bool(velocities or tractions or len(boxes) or velocity is not None)
    load = load or ("sides" if sides else "stretch")
    set_load(solve, _LOADS, load, axis, smooth_platens, rigid_platens, platen_layers, 1e-6, stress, strain_energy)
    solve.SetPull(load != "sides")
    solve.SetStrainRate(0.0 if strain_rate is None else float(strain_rate))
    solve.SetTravelTimes(float(travel_times))
    solve.SetStartShare(float(start))
    for side, vector in entries(velocities, "velocities", "{side: vector}"):
        for component, value in _each(vector, "a velocity"):
            solve.SetSideVelocity(side, component, value)
    for side, vector in entries(tractions, "tractions", "{side: vector}"):
        for component, value in _each(vector, "a traction"):
            solve.SetSideTraction(side, component, value)
    for low, high, vector in boxes:
        corners = [float(c) for corner in (low, high) for c in (*corner, 0.0)[:3]]
        for component, value in _each(vector, "a velocity"):
            solve.AddBoxVelocity(*corners, component, value)
    if velocity is not None and np.ndim(velocity) == 1:
        solve.SetInitialVelocity(*(*map(float, velocity), 0.0)[:3])
    elif velocity is not None:
        sample = _with_velocity(sample, velocity)
        solve.UseInputVelocityOn()
    solve.SetInputData(sample)
    for setter, value in (
        (solve.SetRelaxation, tau),
        (solve.SetReferenceEnergy, omega0),
        (solve.SetReferenceCrack, delta_l),
        (solve.SetTimeStep, step),
        (solve.SetEndTime, end_time),
    ):
        setter(0.0 if value is None else float(value))
    solve.SetStartRate(float(start_rate))
    solve.SetDamping(float(damping))
    solve.SetStepShare(float(step_share))
    solve.SetHistoryEvery(int(history_every))
    for time in np.ravel(at_times):
        solve.AddStateAtTime(float(time))
    return run_breaks(
        solve, DynamicsResult, progress, compression, stop, max_strain, max_broken, at_broken, displacement,
        checkpoint, checkpoint_every, continue_from, on_step,
    )
