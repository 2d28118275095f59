"""Bonds in motion: waves, cracks that run, strength by a damped pull, with every energy accounted for."""

from __future__ import annotations

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkImageData

from . import _arrays
from ._arrays import told
from ._bonds import FORMERLY
from ._breaks import BreakResult, BrokenState, run_breaks
from ._errors import choose, entries
from ._samples import ImageBase
from ._settings import Settings, declared
from ._solve import as_image
from ._types import Array, ArrayLike, Image, Mapping, OnStep, Progress, Sequence
from .vtkLamellaSolversVTK import vtkBondDynamics

_ENERGIES = "kinetic elastic broken damped supplied".split()


class MotionState(BrokenState):
    """The sample at one time: ``vtk`` is the image with ``damage``, ``broken``, ``velocity`` and what was asked for."""

    time: float = told("Since the start [s].")
    velocity: Array = told("[m/s], x, y (and z) in the last axis (a view).", by="_vectors")

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

    time: Array = told("History: times [s].", by="_column")
    strain: Array = told("History: strains at ``time``.", by="_column")
    rate: Array = told("History: imposed speeds over what they are without regulation.", by="_column")

    @property
    def energies(self) -> dict[str, Array]:
        """History [J]: a dictionary of "kinetic", "elastic", "broken", "damped" and "supplied"."""
        return {name: self._column(name + "_energy") for name in _ENERGIES}

    energy_defect: Array = told(
        "History: what the energies miss or have too much, over the largest of them.", by="_column")

    @property
    def broken(self) -> Array:
        """The broken bonds in order, a structured array: ``event`` (from 1; those of one step share it), ``step``,
        ``time`` [s], ``energy`` that it held [J], ``position`` of the middle and ``bond`` vector (x, y (and z) [m]),
        ``phases`` of both ends (the lesser first), ``between_grains``."""
        return self._broken_bonds()

    velocity: Array = told("At the end: [m/s], x, y (and z) in the last axis (a view).", by="_at_end")
    steps: int = told("How many there were.")
    time_step: float = told("Of the integration [s].")
    stable_step: float = told("The largest stable step [s].")
    strain_rate: float = told("Of a pull [1/s]; NaN without.")
    travel_time: float = told("Of a pull: of a wave from platen to platen [s]; NaN without.")

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


@declared(vtkBondDynamics, first=("young", "density", "fracture_energy", "toughness", "critical_stretch"), formerly={
    "void_bonds": FORMERLY["void_bonds"], "step": "time_step"}, without=(
    "keep_states", "state", "large_strains", "tolerance", "load", "pull", "phase_density", "side_velocity", "side_traction", "box_velocity",
    "initial_velocity", "use_input_velocity", "velocity"))
def dynamics(
    image: Image,
    settings: Settings,
    load: str | None = None,
    velocities: Mapping[str, Sequence[float | None]] | None = None,
    tractions: Mapping[str, Sequence[float | None]] | None = None,
    boxes: Sequence[tuple] = (),
    velocity: ArrayLike | None = None,
    progress: Progress | None = None,
    on_step: OnStep | None = None,
) -> DynamicsResult:
    """Moves a sample, breaks its bonds as they become critical, and returns a DynamicsResult.

    image           as fracture() takes it; a density may be {phase: number}
    load            "stretch", "shear": platens pull the sample; "sides": what is said of sides, boxes and velocities moves it;
                    None: "sides" where anything is said of them, else "stretch"
    velocities      {side: vector}: nodes of sides "x-", "x+", "y-", "y+" (the top of a picture), "z-", "z+" keep a velocity
                    [m/s]; None for a component that is free: {"x-": (5, None)}
    tractions       {side: vector}: force on the area of a side [Pa]
    boxes           ((low corner, high corner, vector), ...): nodes between two corners [m] keep a velocity
    velocity        of all that is free, at the start [m/s]: a vector, or one for each node in the order of pictures
    on_step         called as on_step(state) with each state that the run comes to, as ``states`` has them; memory then holds
                    one at a time, and the result has the last one only

    Forces are exact for large strains. A checkpoint that is there already is only replaced where continue_from names it too.
    """
    solve = vtkBondDynamics()
    sample = as_image(image)
    sides = bool(velocities or tractions or len(boxes) or velocity is not None)
    load = load or ("sides" if sides else "stretch")
    solve.SetLoad(choose({"stretch": 0, "shear": 1, "sides": 0}, load, "load"))
    solve.SetPull(load != "sides")
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
    return run_breaks(solve, sample, DynamicsResult, settings, progress, on_step)
