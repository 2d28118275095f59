"""What solvers on bonds share: their settings, and what they say of the sample."""

from __future__ import annotations

from difflib import get_close_matches


from . import _arrays
from ._arrays import told
from ._errors import LamellaError, choose
from ._samples import ImageBase
from ._types import Array

_COMPONENTS = {"xx": 0, "yy": 1, "zz": 2, "xy": 3, "yz": 4, "xz": 5}


class BondNumbers(ImageBase, _arrays.Answer):
    """What solvers on bonds say of the sample and its bonds."""

    @property
    def _dimension(self):
        return 3 if self.vtk.GetDimensions()[2] > 1 else 2

    effective_modulus: float = told(
        "Force on the platen over the section of the box, over the strain [Pa]; a shear modulus under shear.")

    @property
    def pairs(self) -> dict[str, dict[str, float]]:
        """What each pair of phases was given: {pair: {"young", "critical_stretch", "fracture_energy", "toughness"}}."""
        names = _arrays.texts(self.vtk, "pair_names")
        keys = ("young", "critical_stretch", "fracture_energy", "toughness")
        columns = ("youngs_modulus", "critical_stretch", "fracture_energy", "toughness")
        values = [_arrays.numbers(self.vtk, "pair_" + column) for column in columns]
        return {name: {k: float(v[i]) for k, v in zip(keys, values)} for i, name in enumerate(names)}

    @property
    def platens(self) -> tuple[tuple[int, int], tuple[int, int]]:
        """Layers that the platens hold, counted from 0 along the axis: ((first, last), (first, last))."""
        a, b, c, d = (int(n) for n in _arrays.numbers(self.vtk, "platen_layers"))
        return (a, b), (c, d)

    axis: str = told('Axis of loading: "x", "y" or "z".', "load_axis")

    def _vectors(self, name):
        return self.array(name)[..., : self._dimension]

    @property
    def loose_pieces(self) -> tuple[int, int]:
        """Number of pieces that hang on no platen, and of their nodes."""
        return self._count("loose_pieces"), self._count("loose_nodes")


class BondFields(BondNumbers):
    """What they say of every node. y points up."""

    displacement: Array = told("[m], x, y (and z) in the last axis; in the order of pictures (a view).", by="_vectors")
    stress: Array = told(
        "[Pa], the six components xx, yy, zz, xy, yz, xz in the last axis (a view); asked for with stress=True.")

    def stress_component(self, name: str) -> Array:
        """One component of the stress [Pa], "xx" to "xz", in the order of pictures (a view)."""
        return self.stress[..., choose(_COMPONENTS, name, "component")]

    strain_energy: Array = told("[J/m^3], in the order of pictures (a view); asked for with strain_energy=True.")
    hinges: int = told("Nodes that hang on too few bonds to resist in every direction.")


class BreakInputs:
    """What the materials do to the stress of the first break; all empty where it was not asked for, or nothing breaks."""

    def _of_break(self, name):
        return _arrays.numbers(self.vtk, name) if self.vtk.GetFieldData().HasArray(name) else []

    @property
    def sensitivity(self) -> dict[str, dict[str, float]]:
        """Of "first_break_stress" by each value of the materials ("young:wall", as the words of their settings) the derivative
        of the one by the other, in their units."""
        by = dict(zip(_arrays.texts(self.vtk, "material_numbers"), map(float, self._of_break("first_break_sensitivity"))))
        return {"first_break_stress": by} if by else {}

    @property
    def relative_sensitivity(self) -> dict[str, dict[str, float]]:
        """The same of logarithms: what 1 % more of a value does, in per cent."""
        values = dict(zip(_arrays.texts(self.vtk, "material_numbers"), self._of_break("material_values")))
        return {
            name: {number: float(change * values[number] / self._number(name)) for number, change in by.items()}
            for name, by in self.sensitivity.items()
        }

    @property
    def input_errors(self) -> dict[str, float]:
        """What the uncertainty of the materials leaves of "first_break_stress" [Pa]; empty where none was given."""
        return {"first_break_stress": float(error) for error in self._of_break("first_break_input_error")}


WORDS = (("void", "pore", "lumen", "air"), ("wall", "secondary wall"), ("middle lamella", "lamella"))


def means(known, name):
    """Whether a name is one of these, or another word for just one of them: solvers/lattice/PhaseNames.h."""
    return name in known or any(name in words and sum(other in words for other in known) == 1 for words in WORDS)


def check_names(image, names, pairs=True):
    """Raises LamellaError for names that fit no phase of the image, and no pair of its phases: the solver leaves them out, so
    that rows of ParaView's panels suit samples of several kinds; in a script they are slips."""
    known = _arrays.texts(image, "phase_names")

    def fits(name):
        return not known or means(known, name) or name.isdigit()  # values that the table has no name for

    for name in names:
        cuts = [i for i, letter in enumerate(name) if letter == "-"] if pairs else []
        if not fits(name) and not any(fits(name[:i]) and fits(name[i + 1 :]) for i in cuts):
            words = [*known, *(f"{a}-{b}" for a in known for b in known)] if pairs else known
            close = get_close_matches(name, words, 1)
            listed = "its phases are " + ", ".join(map(repr, known))
            message = f"{name!r} is no phase{' or pair of phases' if pairs else ''} of this sample"
            raise LamellaError(message, f"did you mean {close[0]!r}?" if close else listed)


#: words of earlier versions
FORMERLY = {
    "void_bonds": lambda word: {"cut_void_bonds": choose({"keep": False, "cut": True}, word, "void_bonds")},
    "strains": lambda word: {"large_strains": choose({"small": False, "large": True}, word, "strains")},
}
MATERIALS = ("young", "fracture_energy", "toughness", "critical_stretch")


def give_bonds(settings, algorithm, image):
    """Sets what was given, where its names are those of the image."""
    settings.give(algorithm, lambda names, pairs: check_names(image, names, pairs))
