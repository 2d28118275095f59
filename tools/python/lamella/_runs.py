"""What runs share that load a sample for long: its states, and checkpoints."""

from __future__ import annotations

import os

from vtkmodules.util.numpy_support import vtk_to_numpy

from . import _arrays
from ._arrays import told


class LoadedState(_arrays.FieldData):
    """A sample under a load."""

    imposed_strain: float = told("The strain in this state.", "strain")
    imposed_stress: float = told("The stress in it [Pa]: force on the platen over the section of the box.", "stress")


class LongRun(_arrays.FieldData):
    """A run that writes checkpoints and goes on from them. ``vtk_curve`` is its curve, a vtkTable."""

    def _column(self, name):
        return vtk_to_numpy(self.vtk_curve.GetColumnByName(name))

    continued_at: int = told(
        "What the checkpoint stands after that the run went on from, events or steps; 0 where it began anew.")
    last_checkpoint: int = told("What the last checkpoint of this run stands after, events or steps; 0: none.")


def check_checkpoint(settings):
    """An error where a checkpoint is there that is not to be replaced."""
    checkpoint, continue_from = (os.fspath(settings.values.get(name) or "") for name in ("checkpoint", "continue_from"))
    if checkpoint != continue_from and os.path.exists(checkpoint):
        raise FileExistsError(f"{checkpoint} exists; remove it, or say continue_from={checkpoint!r} to go on from it")
