"""How far a sample speaks for its material."""

from __future__ import annotations

from . import _arrays
from ._arrays import told


class WindowErrors:
    """What results tell that were asked for a window error; all empty where they were not."""

    def _by_window(self, name):
        if not self.vtk.GetFieldData().HasArray("window_of"):
            return {}
        return dict(zip(_arrays.texts(self.vtk, "window_of"), map(float, _arrays.numbers(self.vtk, name))))

    window_errors: dict[str, float] = told(
        "How far the material that the sample was cut out of may be from its values, relative, by name.", by="_by_window")
    window_low: dict[str, float] = told(
        "The intervals that hold the material's values with 95 %, by name.", by="_by_window")
    window_high: dict[str, float] = told("Their other ends.", by="_by_window")
    window_deviation: dict[str, float] = told(
        "Standard deviations between the values of samples of this size, by name.", by="_by_window")
    window_bias: dict[str, float] = told(
        "Values of the sample less the material's because the sample ends, as far as its windows tell, by name.",
        by="_by_window")
    window_gradient: dict[str, float] = told(
        "Axis, 0 to 2, along which the sample changes steadily, by name; NaN: it does not.", by="_by_window")
