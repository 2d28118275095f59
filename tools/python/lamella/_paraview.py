"""The ParaView plugin."""

from __future__ import annotations

import json
import os
import sysconfig

from ._errors import choose
from ._types import Any, Path


def plugin_path() -> str:
    """Where the ParaView plugin is: beside this package, in the build tree or in the installation."""
    here = os.path.dirname(os.path.abspath(__file__))
    places = [os.path.join(here, *[".."] * up, "lib", *arch) for up in (2, 4) for arch in ((), (sysconfig.get_config_var("MULTIARCH") or "",))]
    places.append(os.path.join(here, "..", "..", ".."))  # the package is installed below the library folder
    for place in places:
        path = os.path.normpath(os.path.join(place, "lamella", "Lamella", "Lamella.so"))
        if os.path.exists(path):
            return path
    raise FileNotFoundError(f"no ParaView plugin beside {here}: build with LAMELLA_BUILD_PLUGIN on")


def load_plugin(namespace: dict[str, Any] | None = None, server_path: Path | None = None) -> None:
    """Loads the plugin into pvpython, pvbatch or the window, on all ranks, and into the server that it is connected to:
    its sources and filters then work like ParaView's own.

    namespace    where their names go: ``lamella.load_plugin(globals())`` after ``from paraview.simple import *``; None:
                 use them as ``paraview.simple.SteadyDiffusion``
    server_path  where the plugin is on the server; None: where it is here
    """
    from paraview import servermanager, simple  # pylint: disable=import-outside-toplevel

    names = vars(simple) if namespace is None else namespace
    simple.LoadPlugin(plugin_path(), remote=False, ns=names)
    connection = servermanager.ActiveConnection
    if connection is not None and connection.IsRemote():
        simple.LoadPlugin(os.fspath(server_path or plugin_path()), remote=True, ns=names)


def _presets(name: str) -> str:
    return os.path.join(os.path.dirname(plugin_path()), "presets", name)


def load_presets() -> list[str]:
    """Gives ParaView the colour maps for phases, damage and stress, once, and returns their names.

    Use one as ``GetColorTransferFunction("damage").ApplyPreset("Lamella Damage", True)``, or choose it in the window.
    """
    from paraview import servermanager  # pylint: disable=import-outside-toplevel

    with open(_presets("colors.json"), encoding="utf-8") as file:
        maps = json.load(file)
    known = servermanager.vtkSMTransferFunctionPresets.GetInstance()
    for colors in maps:
        if not known.HasPreset(colors["Name"]):
            known.AddPreset(colors["Name"], json.dumps(colors))
    return [colors["Name"] for colors in maps]


def use_preset(source: Any, name: str) -> str:
    """Gives a source or filter of ParaView the materials of a paper, and returns where they are from.

    source  as ``paraview.simple.BondFracture(...)`` or ``paraview.simple.GetActiveSource()``; only properties that it has
            are set
    name    "cemented grains", "wood that breaks", "wood, heat", "wood, vapour" or "wood that is pressed"
    """
    with open(_presets("materials.json"), encoding="utf-8") as file:
        presets = {preset["name"]: preset for preset in json.load(file)}
    preset = choose(presets, name, "preset")
    has = set(source.ListProperties()) if hasattr(source, "ListProperties") else set()
    fitting = {key: value for key, value in preset["properties"].items() if key in has}
    if not fitting:
        raise ValueError(f"preset {name!r} has nothing for this source; it sets {', '.join(preset['properties'])}")
    for key, value in fitting.items():
        setattr(source, key, value)
    return preset["source"]
