"""What runs share that load a sample for long: its states, and checkpoints."""

from __future__ import annotations

import os

from . import _arrays


class LoadedState(_arrays.FieldData):
    """A sample under a load."""

    @property
    def imposed_strain(self) -> float:
        """The strain in this state."""
        return self._number("strain")

    @property
    def imposed_stress(self) -> float:
        """The stress in it [Pa]: force on the platen over the section of the box."""
        return self._number("stress")


class LongRun(_arrays.FieldData):
    """A run that writes checkpoints and goes on from them."""

    @property
    def continued_at(self) -> int:
        """What the checkpoint stands after that the run went on from, events or steps; 0 where it began anew."""
        return self._count("continued_at")

    @property
    def last_checkpoint(self) -> int:
        """What the last checkpoint of this run stands after, events or steps; 0: none."""
        return self._count("last_checkpoint")


def check_checkpoint(settings):
    """An error where a checkpoint is there that is not to be replaced."""
    checkpoint, continue_from = (os.fspath(settings.values.get(name) or "") for name in ("checkpoint", "continue_from"))
    if checkpoint != continue_from and os.path.exists(checkpoint):
        raise FileExistsError(f"{checkpoint} exists; remove it, or say continue_from={checkpoint!r} to go on from it")
