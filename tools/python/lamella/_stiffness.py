"""Effective stiffness by elements on the lattice, and stresses under a mean load."""

from __future__ import annotations

from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData

from . import _arrays, _files
from ._arrays import checked, image_of, told
from ._bonds import check_names
from ._errors import run
from ._samples import ImageBase
from ._settings import Settings, declared
from ._solve import as_image
from ._stiffness_results import StiffnessBase
from ._types import Any, Array, Image, Path, Progress
from ._windows import WindowErrors
from .vtkLamellaSolversVTK import vtkVoxelStiffness


class StiffnessResult(WindowErrors, StiffnessBase):
    """``vtk`` is the image with all numbers as field data and the fields of a load; ``vtk_tensor`` and ``vtk_constants``
    are vtkTables, ``vtk_directions`` a vtkPolyData.

    Tensors are 3 by 3 of a picture (xx, yy, xy) and 6 by 6 of a volume (xx, yy, zz, yz, xz, xy), shear strains as
    angles. y points up.
    """

    def __init__(self, image, tensor, constants, directions) -> None:
        super().__init__(image, tensor, constants)
        #: a closed surface, of a picture a line: the elastic constants by direction
        self.vtk_directions = directions

    @property
    def isotropic(self) -> dict[str, float]:
        """The nearest isotropic tensor: bulk, shear and Young's modulus [Pa], Poisson's ratio, and the share of the
        tensor's norm that it leaves ("rest")."""
        return dict(zip(("bulk", "shear", "young", "poisson", "rest"), map(float, _arrays.numbers(self.vtk, "isotropic_part"))))

    @property
    def orthotropic(self) -> dict[str, Any]:
        """The nearest orthotropic tensor: "stiffness" in its own "axes" (one a row) [Pa], and the share that it leaves
        ("rest")."""
        axes = _arrays.numbers(self.vtk, "orthotropic_axes").reshape(3, 3)
        return {"stiffness": self._tensor("orthotropic_part"), "axes": axes, "rest": self._number("orthotropic_rest")}

    @property
    def by_direction(self) -> dict[str, dict[str, dict[str, Any]]]:
        """Over all directions the "least" and the "most" of "young", "shear" [Pa] and "poisson", each with its "value", the
        "direction" (unit vector, of a volume 3, of a picture 2 numbers), and of the last two the direction "across" it."""
        axes = 3 if len(self.components) == 6 else 2
        values = _arrays.numbers(self.vtk, "extremes")
        along, across = (_arrays.numbers(self.vtk, name).reshape(-1, 3)[:, :axes] for name in ("extreme_directions", "extreme_across"))
        found: dict[str, dict[str, dict[str, Any]]] = {}
        for i, value in enumerate(values):
            one = {"value": float(value), "direction": along[i]}
            if i > 1:
                one["across"] = across[i]
            found.setdefault(("young", "shear", "poisson")[i // 2], {})["most" if i % 2 else "least"] = one
        return found

    @property
    def hashin_shtrikman(self) -> dict[str, tuple[float, float]]:
        """Bounds of isotropic mixtures, lower and upper, of "bulk" and "shear" modulus [Pa]; empty where a phase is not
        isotropic."""
        found = [float(v) for v in _arrays.numbers(self.vtk, "hashin_shtrikman")]
        return {"bulk": tuple(found[:2]), "shear": tuple(found[2:])} if len(found) else {}

    @property
    def sensitivity(self) -> dict[str, dict[str, float]]:
        """By constant and by number of the materials ("young:wall", as the words of their settings) the derivative of the
        one by the other, in their units; empty where it was not asked for."""
        found = self._numbers("constants_sensitivity")
        if found is None:
            return {}
        names = _arrays.texts(self.vtk, "material_numbers")
        return {constant: dict(zip(names, map(float, row))) for constant, row in zip(self.constants, found.reshape(len(names), -1).T)}

    @property
    def relative_sensitivity(self) -> dict[str, dict[str, float]]:
        """The same of logarithms: what 1 % more of a number does, in per cent; NaN of constants of 0."""
        found = self.sensitivity
        values = dict(zip(_arrays.texts(self.vtk, "material_numbers"), self._numbers("material_values"))) if found else {}
        scale = {constant: 1 / value if value else float("nan") for constant, value in self.constants.items()}
        return {constant: {name: float(by * values[name] * scale[constant]) for name, by in row.items()} for constant, row in found.items()}

    def _known(self, name):
        return {} if self._numbers(name) is None else self._by_constant(name)

    input_errors: dict[str, float] = told(
        "What the uncertainty of the materials leaves of each constant, in its unit; empty where none was given.",
        "constants_input_error", by="_known")
    segmentation_errors: dict[str, float] = told(
        "How far each constant may be off because surfaces between phases lie elsewhere, in its unit; empty unless it was"
        " asked for.", "constants_segmentation_error", by="_known")
    total_errors: dict[str, float] = told(
        "The root of the squares of these, of the estimated error and of the window's, NaN where no two are known; empty "
        "where none beside the estimated error was asked for.", "constants_total_error", by="_known")
    expansion: Array = told(
        "Mean strain of the free box for a change of 1 by component [1], shears as angles; none where no phase expands.", by="_numbers")
    load_strain: Array = told("Mean strain of the load by component [1], shears as angles; none where there was no load.", by="_numbers")
    load_stress: Array = told("Mean stress of the load by component [Pa]; none where there was no load.", by="_numbers")
    solver_error: float = told("Error of energies that iterations leave, relative, estimated [1].")

    def _field(self, name):
        found = self.vtk.GetPointData().GetArray(name)
        if found is None:
            raise KeyError(f"there is no {name}: give a mean strain, a mean stress or a change")
        values = vtk_to_numpy(found)
        return values.reshape(*reversed(self.vtk.GetDimensions()), values.shape[-1])

    displacement: Array = told("Of a load: z by y by x by 3 [m], from the image's middle (a view).", by="_field")
    strain: Array = told("Of a load: z by y by x by 6, xx, yy, zz, xy, yz, xz (a view).", by="_field")
    stress: Array = told("Of a load: z by y by x by 6, xx, yy, zz, xy, yz, xz [Pa] (a view).", by="_field")

    def save_directions(self, path: Path, overwrite: bool = False) -> str:
        """Writes the elastic constants by direction as a .vtp file, whole or not at all."""
        return _files.save_poly_data(self.vtk_directions, path, overwrite)


def result_of(solve):
    """What a vtkVoxelStiffness holds that has run."""
    return StiffnessResult(solve.GetImage(), solve.GetTensor(), solve.GetConstants(), solve.GetDirections())


@declared(vtkVoxelStiffness, first=("young", "poisson"))
def stiffness(image: Image, settings: Settings, progress: Progress | None = None) -> StiffnessResult:
    """Effective stiffness tensor of a sample by elements, with its error; returns a StiffnessResult.

    image           a picture, volume or result with phases, as equilibrium() takes it

    With mean_strain, mean_stress or change also the displacement, strain and stress under that load.
    """
    solve = vtkVoxelStiffness()
    if any(settings["shares"]) and not isinstance(image, (ImageBase, vtkImageData)):
        image = image_of(checked(image, "the grey image", "give real numbers"), 1.0, "phase")
    sample = as_image(image)
    solve.SetInputData(sample)
    settings.give(solve, None if any(settings["shares"]) else lambda names, pairs: check_names(sample, names, pairs))
    run(solve, progress)
    return result_of(solve)
