"""Diffusion in time."""

from __future__ import annotations

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkImageData

from . import _arrays
from ._errors import choose, entries, number, run
from ._runs import set_checkpoint
from ._samples import ImageBase
from ._solve import _LATTICES, as_image
from ._types import Array, ArrayLike, Image, Mapping, Name, OnStep, Path, Progress, Sequence
from .vtkLamellaSolversVTK import vtkLatticeBoltzmann

_COLLISIONS = {"auto": 0, "bgk": 1, "trt": 2}


class TransientState(ImageBase):
    """The sample at one time: ``vtk`` is the image with the field and, where it was asked for, its ``flux``."""

    def _number(self, name):
        return float(_arrays.numbers(self.vtk, name)[0])

    @property
    def time(self) -> float:
        """Since the start [s]."""
        return self._number("time")

    @property
    def field(self) -> Array:
        """Temperature or concentration in the order of pictures, NaN where nothing conducts (a view)."""
        return self.array(self.vtk.GetPointData().GetScalars().GetName())

    @property
    def flux(self) -> Array:
        """-D grad u [m/s], x, y and z in the last axis (a view); only where it was asked for."""
        return self.array("flux")

    def __repr__(self) -> str:
        return f"<lamella.TransientState: {self.time:.6g} s>"


class TransientResult:
    """What a run gives: ``states``, and the numbers of all of them as arrays."""

    def __init__(self, states, curve) -> None:
        #: a TransientState for each time kept; where the run went on from a checkpoint, from there on
        self.states = states
        #: their times [s]
        self.times = np.array([state.time for state in states])
        #: by time kept, also before the checkpoint: "time" [s], "inlet_flux", "outlet_flux" [m/s], "mean_value", "steps"
        self.curve = curve

    def _each(self, name):
        return np.array([state._number(name) for state in self.states])

    @property
    def inlet_flux(self) -> Array:
        """Mean flux through the face where the direction begins [m/s], by time."""
        return self._each("inlet_flux")

    @property
    def outlet_flux(self) -> Array:
        """Mean flux through the face where it ends [m/s], by time."""
        return self._each("outlet_flux")

    @property
    def mean(self) -> Array:
        """Mean of the field over the box, 0 where nothing conducts, by time."""
        return self._each("mean_value")

    @property
    def time_step(self) -> float:
        """Of lattice Boltzmann [s]."""
        return self.states[-1]._number("time_step")

    @property
    def relaxation(self) -> float:
        """tau - 1/2 of the phase that conducts best."""
        return self.states[-1]._number("relaxation")

    @property
    def steps(self) -> int:
        """How many there were."""
        return int(self.states[-1]._number("steps"))

    @property
    def continued_at(self) -> int:
        """Steps in the checkpoint that the run went on from; 0 where it began anew."""
        return int(self.states[-1]._number("continued_at"))

    @property
    def last_checkpoint(self) -> int:
        """Steps in the last checkpoint of this run; 0: none."""
        return int(self.states[-1]._number("last_checkpoint"))

    @property
    def warning(self) -> str:
        """Where one relaxation time is inaccurate, what to expect; else empty."""
        return self.states[-1].vtk.GetFieldData().GetAbstractArray("warning").GetValue(0)

    def __repr__(self) -> str:
        return f"<lamella.TransientResult: {self.times[-1]:.6g} s in {self.steps} steps, {len(self.states)} states>"


def lattice_boltzmann(
    image: Image,
    diffusivity: Mapping[Name, float],
    end_time: float | None = None,
    frames: int = 10,
    direction: str = "x",
    values: Sequence[float] = (1.0, 0.0),
    initial: float = 0.0,
    sides: str = "insulated",
    quantity: str = "temperature",
    stepping: str = "auto",
    lattice: str | None = None,
    time_step: float | None = None,
    flux: bool = False,
    threads: int = 1,
    progress: Progress | None = None,
    on_step: OnStep | None = None,
    at_times: ArrayLike = (),
    at_steps: ArrayLike = (),
    checkpoint: Path | None = None,
    checkpoint_every: int = 10000,
    continue_from: Path | None = None,
) -> TransientResult:
    """Steps diffusion through time by lattice Boltzmann and returns a TransientResult.

    image        a Sample, a vtkImageData with the point array ``phase``, or an array of whole numbers
    diffusivity  {name or number of the phase: value [m2/s]}, one for each phase that occurs, 0 for what does not conduct
    end_time     the last time [s]
    frames       times after 0 that are kept, evenly until the end
    direction    "x" (left to right), "y" (in a picture from top to bottom) or "z"
    values       on the face where the direction begins and on that where it ends
    initial      inside, at time 0
    sides        "insulated" or "periodic": the others
    quantity     "temperature" or "concentration": names the field
    stepping     "auto" and "trt": two relaxation times; "bgk": one, as in the first paper
    lattice      None (d2q5 or d3q7), "d2q5", "d2q9", "d3q7" or "d3q19"
    time_step    [s]; None: short enough to be accurate, and such that every time is met
    flux         whether the flux is kept too
    threads      0: all cores
    progress     called as progress(share, text); return False to cancel (raises Cancelled)
    on_step      called as on_step(state) with the TransientState of each time; memory then holds one at a time, and the result
                 has the last one only
    at_times     [s], at_steps: even numbers of steps: kept instead of evenly spaced times; the last of them is the end
    checkpoint, checkpoint_every, continue_from  as fracture() takes them; in steps. A run goes on to the same bits, at the
                 same time step; other times may be asked for
    """
    at_times, at_steps = np.ravel(at_times), np.ravel(at_steps)
    if (end_time is None) == (at_times.size + at_steps.size == 0):
        raise ValueError("give end_time, or at_times and at_steps")
    solver = vtkLatticeBoltzmann()
    solver.SetInputData(as_image(image))
    for name, value in entries(diffusivity, "diffusivity", "{phase: value}"):
        solver.SetDiffusivity(str(name), number(value, f"the diffusivity of {name!r}"))
    if end_time is not None:
        solver.SetEndTime(end_time)
    solver.SetNumberOfSteps(frames)
    for time in at_times:
        solver.AddStateAtTime(float(time))
    for step in at_steps:
        solver.AddStateAtStep(int(step))
    solver.SetDirection(choose({"x": 0, "y": 1, "z": 2}, direction, "direction"))
    solver.SetInletValue(values[0])
    solver.SetOutletValue(values[1])
    solver.SetInitialValue(initial)
    solver.SetSides(choose({"insulated": 0, "periodic": 1}, sides, "sides"))
    solver.SetQuantity(choose({"temperature": 0, "concentration": 1}, quantity, "quantity"))
    solver.SetCollision(choose(_COLLISIONS, stepping, "stepping"))
    solver.SetLattice(choose(_LATTICES, lattice, "lattice"))
    solver.SetTimeStep(0 if time_step is None else time_step)
    solver.SetComputeFlux(bool(flux))
    solver.SetThreads(threads)
    set_checkpoint(solver, checkpoint, checkpoint_every, continue_from)
    run(solver, progress, on_step, TransientState)
    states = []
    for k in range(solver.GetNumberOfStates()):
        state = vtkImageData()
        state.ShallowCopy(solver.GetStateImage(k))
        states.append(TransientState(state))
    return TransientResult(states, {name: column.copy() for name, column in _arrays.columns(solver.GetCurve()).items()})
