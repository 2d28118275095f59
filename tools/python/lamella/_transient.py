"""Diffusion in time."""

from __future__ import annotations

import functools
import warnings

import numpy as np
from vtkmodules.vtkCommonDataModel import vtkImageData

from . import _arrays
from ._arrays import told
from ._errors import run
from ._runs import check_checkpoint
from ._samples import ImageBase
from ._settings import Settings, declared
from ._solve import as_image
from ._types import Array, Image, OnStep, Progress
from .vtkLamellaSolversVTK import vtkLatticeBoltzmann


class TransientState(ImageBase):
    """The sample at one time: ``vtk`` is the image with the field and, where it was asked for, its ``flux``."""

    time: float = told("Since the start [s].")

    @property
    def field(self) -> Array:
        """Temperature or concentration in the order of pictures, NaN where nothing conducts (a view)."""
        return self.array(self.vtk.GetPointData().GetScalars().GetName())

    flux: Array = told("-D grad u [m/s], x, y and z in the last axis (a view); only where it was asked for.")

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

    def _number(self, name):
        return self.states[-1]._number(name)

    def _count(self, name):
        return int(self._number(name))

    def _text(self, name):
        return self.states[-1]._text(name)

    def _each(self, name):
        return np.array([state._number(name) for state in self.states])

    inlet_flux: Array = told("Mean flux through the face where the direction begins [m/s], by time.", by="_each")
    outlet_flux: Array = told("Mean flux through the face where it ends [m/s], by time.", by="_each")
    mean: Array = told("Mean of the field over the box, 0 where nothing conducts, by time.", "mean_value", by="_each")
    time_step: float = told("Of lattice Boltzmann [s].")
    relaxation: float = told("tau - 1/2 of the phase that conducts best.")
    steps: int = told("How many there were.")
    continued_at: int = told("Steps in the checkpoint that the run went on from; 0 where it began anew.")
    last_checkpoint: int = told("Steps in the last checkpoint of this run; 0: none.")
    warning: str = told("Where one relaxation time is inaccurate, what to expect; else empty.")

    def __repr__(self) -> str:
        return f"<lamella.TransientResult: {self.times[-1]:.6g} s in {self.steps} steps, {len(self.states)} states>"


@declared(vtkLatticeBoltzmann, first=("diffusivity", "end_time", "frames", "direction"), without=("keep_states",),
          formerly={"values": lambda pair: dict(zip(("inlet_value", "outlet_value"), pair)), "initial": "initial_value"})
def transient(
    image: Image, settings: Settings, progress: Progress | None = None, on_step: OnStep | None = None
) -> TransientResult:
    """Steps diffusion through time by lattice Boltzmann and returns a TransientResult.

    image           a Sample, a vtkImageData with the point array ``phase``, or an array of whole numbers
    on_step         called as on_step(state) with the TransientState of each time; memory then holds one at a time, and the
                    result has the last one only
    """
    given = settings.values
    if (given.get("end_time") is None) == (np.size(given.get("at_times", ())) + np.size(given.get("at_steps", ())) == 0):
        raise ValueError("give end_time, or at_times and at_steps")
    solver = vtkLatticeBoltzmann()
    solver.SetInputData(as_image(image))
    check_checkpoint(settings)
    settings.give(solver)
    run(solver, progress, on_step, TransientState)
    states = []
    for k in range(solver.GetNumberOfStates()):
        state = vtkImageData()
        state.ShallowCopy(solver.GetStateImage(k))
        states.append(TransientState(state))
    return TransientResult(states, {name: column.copy() for name, column in _arrays.columns(solver.GetCurve()).items()})


@functools.wraps(transient)
def lattice_boltzmann(*given, **keywords):
    warnings.warn("lattice_boltzmann() is now called transient(), as in the shell; the next version does not know lattice_boltzmann any more",
                  FutureWarning, stacklevel=2)
    return transient(*given, **keywords)
