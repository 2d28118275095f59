"""What results share that hold a stiffness tensor."""

from __future__ import annotations

import numpy as np

from . import _arrays
from ._arrays import told
from ._samples import ImageBase
from ._types import Any, Array, Sequence


class StiffnessBase(ImageBase, _arrays.Answer):
    """``vtk`` is the image with all numbers as field data; ``vtk_tensor`` and ``vtk_constants`` are vtkTables.

    Tensors are 3 by 3 of a picture (xx, yy, xy) and 6 by 6 of a volume (xx, yy, zz, yz, xz, xy), shear strains as
    angles. y points up.
    """

    def __init__(self, image, tensor, constants) -> None:
        super().__init__(image)
        #: one row a stress
        self.vtk_tensor = tensor
        #: one row a constant
        self.vtk_constants = constants

    def _tensor(self, name):
        n = len(self.components)
        return _arrays.numbers(self.vtk, name).reshape(n, n)

    def _by_constant(self, name):
        return dict(zip(_arrays.texts(self.vtk, "constant_names"), map(float, _arrays.numbers(self.vtk, name))))

    components: list[str] = told("Names of rows and columns.", "stiffness_components")
    stiffness: Array = told("The tensor at the image's own spacing [Pa].", by="_tensor")
    extrapolated: Array = told(
        "The tensor that the material is expected to have [Pa]; NaN where the error is not known.",
        "stiffness_extrapolated", by="_tensor")
    errors: Array = told(
        "Estimated error of each component [Pa]; NaN where it is not known.", "stiffness_error", by="_tensor")
    estimated_error: float = told("The largest relative error on the diagonal; NaN where it is not known.")

    @property
    def bounds(self) -> dict[str, Array]:
        """Voigt's and Reuss's bounds of the tensor [Pa], a dictionary."""
        return {name: self._tensor("stiffness_" + name) for name in ("voigt", "reuss")}

    constants: dict[str, float] = told(
        "Young's and shear moduli [Pa] and Poisson's ratios by name: E_x ..., nu_xy ..., G_xy ...", by="_by_constant")
    constants_extrapolated: dict[str, float] = told(
        "The same as the material is expected to have it.", by="_by_constant")
    constants_errors: dict[str, float] = told(
        "The estimated errors of the constants, in their own units.", "constants_error", by="_by_constant")
    eigenvalues: Array = told("Stiffnesses of the tensor's own strains, rising [Pa].", by="_numbers")
    resisting: int = told("How many of them are above zero: 3 or 6 unless something is a mechanism.")
    crosses: str = told('Axes along which the solid goes on into the next cell, as "xy".', by="_axes")

    @property
    def steps(self) -> list[dict[str, Any]]:
        """The solves: a list of {"every", "pictures", "nodes", "iterations", "seconds"}; the first is the image's, the
        others are of the pictures that about every second, third and fourth pixel gives."""
        keys = ("every", "pictures", "nodes", "iterations", "seconds")
        kinds = (float, int, int, int, float)
        columns = [_arrays.numbers(self.vtk, "step_" + key) for key in keys]
        return [{k: kind(v) for k, kind, v in zip(keys, kinds, row)} for row in zip(*columns)]

    @property
    def iterations(self) -> dict[str, int]:
        """Of conjugate gradients at the image's own spacing, by unit strain."""
        return dict(zip(self.components, map(int, _arrays.numbers(self.vtk, "iterations"))))

    @property
    def loose_pieces(self) -> float:
        """Number of pieces that go on nowhere, and of their nodes."""
        return int(self._number("loose_pieces")), int(self._number("loose_nodes"))

    @property
    def mismatch(self) -> dict[str, tuple[float, float]]:
        """By axis, share of nodes whose neighbour across the seam is of another phase, and the largest such share
        between two layers within."""
        seam = _arrays.numbers(self.vtk, "seam_mismatch")
        layers = _arrays.numbers(self.vtk, "layer_mismatch")
        axes = "xyz" if len(self.components) == 6 else "xy"
        return {axis: (float(seam[i]), float(layers[i])) for i, axis in enumerate(axes)}

    def modulus(self, direction: Sequence[float]) -> float:
        """Young's modulus [Pa] under stress along a direction: an angle in radians from x of a picture, or a vector."""
        n = len(self.components)
        if np.isscalar(direction):
            direction = (np.cos(direction), np.sin(direction))
        d = np.asarray(direction, float) / np.linalg.norm(direction)
        if d.shape != ((3,) if n == 6 else (2,)):
            raise ValueError(f"a direction has {3 if n == 6 else 2} components here, not {d.size}")
        if self.resisting < n:
            raise ValueError("the cell is a mechanism: some directions have no modulus")
        if n == 6:
            stress = np.array([d[0] ** 2, d[1] ** 2, d[2] ** 2, d[1] * d[2], d[0] * d[2], d[0] * d[1]])
        else:
            stress = np.array([d[0] ** 2, d[1] ** 2, d[0] * d[1]])
        return float(1 / (stress @ np.linalg.solve(self.stiffness, stress)))

    def __repr__(self) -> str:
        numbers = ", ".join(f"{name} {value:.6g}" for name, value in self.constants.items() if name[0] == "E")
        return f"<lamella.{type(self).__name__}: {numbers} Pa, error {100 * self.estimated_error:.2g} %>"
