"""What solvers on bonds share: their settings, and what they say of the sample."""

from __future__ import annotations

from difflib import get_close_matches

import numpy as np

from . import _arrays
from ._errors import LamellaError, choose, entries, number
from ._samples import ImageBase
from ._types import Array

LOADS = {"stretch": 0, "shear": 1, "biaxial": 2}
_AXES = {None: -1, "x": 0, "y": 1, "z": 2}
_MICROMODULI = {None: -1, "continuum": 0, "lattice": 1, "isotropic": 2}
_CONTINUA = {None: 0, "plane-stress": 1, "plane-strain": 2, "space": 3}
_MIXINGS = {None: 0, "none": 0, "harmonic": 1, "minimum": 2}
_COMPONENTS = {"xx": 0, "yy": 1, "zz": 2, "xy": 3, "yz": 4, "xz": 5}


class BondNumbers(ImageBase, _arrays.Answer):
    """What solvers on bonds say of the sample and its bonds."""

    @property
    def _dimension(self):
        return 3 if self.vtk.GetDimensions()[2] > 1 else 2

    @property
    def effective_modulus(self) -> float:
        """Force on the platen over the section of the box, over the strain [Pa]; a shear modulus under shear."""
        return self._number("effective_modulus")

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

    @property
    def axis(self) -> str:
        """Axis of loading: "x", "y" or "z"."""
        return _arrays.text(self.vtk, "load_axis")

    @property
    def loose_pieces(self) -> tuple[int, int]:
        """Number of pieces that hang on no platen, and of their nodes."""
        return self._count("loose_pieces"), self._count("loose_nodes")


class BondFields(BondNumbers):
    """What they say of every node. y points up."""

    @property
    def displacement(self) -> Array:
        """[m], x, y (and z) in the last axis; in the order of pictures (a view)."""
        return self.array("displacement")[..., : self._dimension]

    @property
    def stress(self) -> Array:
        """[Pa], the six components xx, yy, zz, xy, yz, xz in the last axis (a view); asked for with stress=True."""
        return self.array("stress")

    def stress_component(self, name: str) -> Array:
        """One component of the stress [Pa], "xx" to "xz", in the order of pictures (a view)."""
        return self.stress[..., choose(_COMPONENTS, name, "component")]

    @property
    def strain_energy(self) -> Array:
        """[J/m^3], in the order of pictures (a view); asked for with strain_energy=True."""
        return self.array("strain_energy")

    @property
    def hinges(self) -> int:
        """Nodes that hang on too few bonds to resist in every direction."""
        return self._count("hinges")


def set_load(
    algorithm, loads, load, axis, smooth_platens, rigid_platens, platen_layers, tolerance, stress, strain_energy
):
    """Settings of vtkBondLoadAlgorithm; see equilibrium()."""
    algorithm.SetLoad(choose(loads, load, "load"))
    algorithm.SetLoadAxis(choose(_AXES, axis, "axis"))
    algorithm.SetSmoothPlatens(bool(smooth_platens))
    algorithm.SetRigidPlatens(bool(rigid_platens))
    algorithm.SetPlatenLayers(int(platen_layers))
    algorithm.SetTolerance(float(tolerance))
    algorithm.SetComputeStress(bool(stress))
    algorithm.SetComputeStrainEnergy(bool(strain_energy))


def _pair(name):
    return "-".join(map(str, name)) if isinstance(name, tuple) else str(name)


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


def set_bonds(
    algorithm,
    image,
    young=None,
    fracture_energy=None,
    toughness=None,
    critical_stretch=None,
    like=None,
    relative_to=None,
    mixing=None,
    void=None,
    horizon=3.0,
    continuum=None,
    micromodulus=None,
    void_bonds="keep",
    surface_correction=False,
    notches=(),
    periodic=(),
    strains="small",
    threads=1,
):
    """Settings of vtkBondAlgorithm; see equilibrium()."""
    tables = (
        (algorithm.SetYoungsModulus, "young", young),
        (algorithm.SetFractureEnergy, "fracture_energy", fracture_energy),
        (algorithm.SetToughness, "toughness", toughness),
        (algorithm.SetCriticalStretch, "critical_stretch", critical_stretch),
    )
    for setter, name, table in tables:
        given = entries(table, name, "{pair of phases: value}")
        check_names(image, [_pair(pair) for pair, _ in given])
        for pair, value in given:
            setter(_pair(pair), number(value, f"{name} of {pair!r}"))
    alike = entries(like, "like", "{pair of phases: pair of phases}")
    check_names(image, [_pair(pair) for pair, _ in alike])
    for pair, other in alike:
        algorithm.SetLike(_pair(pair), _pair(other))
    algorithm.SetRelativeTo("" if relative_to is None else _pair(relative_to))
    algorithm.SetMixing(choose(_MIXINGS, mixing, "mixing"))
    for name in [void] if isinstance(void, (str, int)) else (void or ()):
        algorithm.AddVoid(str(name))
    algorithm.SetHorizon(float(horizon))
    algorithm.SetContinuum(choose(_CONTINUA, continuum, "continuum"))
    algorithm.SetMicromodulus(choose(_MICROMODULI, micromodulus, "micromodulus"))
    algorithm.SetCutVoidBonds(choose({"keep": False, "cut": True}, void_bonds, "void_bonds"))
    algorithm.SetSurfaceCorrection(bool(surface_correction))
    algorithm.SetLargeStrains(choose({"small": False, "large": True}, strains, "strains"))
    for notch in notches:
        points = [float(value) for value in np.ravel(notch)]
        if len(points) == 4:
            algorithm.AddNotch(*points)
        elif len(points) == 9:
            algorithm.AddNotchInSpace(points[:3], points[3:6], points[6:])
        else:
            raise ValueError("a notch is ((x1, y1), (x2, y2)), or a corner and two edges in space")
    if set(periodic) - set("xyz"):
        raise ValueError(f"periodic is {periodic!r}; it names axes, as 'xy'")
    algorithm.SetPeriodic(*(int(axis in periodic) for axis in "xyz"))
    algorithm.SetThreads(int(threads))
