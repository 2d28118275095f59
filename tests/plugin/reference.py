"""The reference of the Python package in docs/python.md is that of the code, and every public name says what it takes and
gives: types as hints, shapes and units in words.

reference.py DOCS/python.md [--write]
"""

import inspect
import re
import sys
import types
import typing

import lamella

BEGIN = "<!-- reference: made by tests/plugin/reference.py --write -->\n"
SECTIONS = (
    ("Samples", ("from_array", "read_picture", "softwood", "hardwood", "honeycomb", "checkerboard", "disks", "spheres",
                 "laminate", "Sample")),
    ("Micrographs", ("contours", "read_polygons", "outline_diffusion", "Contours", "LatticeSample", "OutlineDiffusionResult")),
    ("Grains", ("packing", "packings", "read_packing", "bridges", "Packing", "CementedSample")),
    ("Diffusion", ("diffusion", "transient", "flux_map", "DiffusionResult", "TransientResult", "TransientState",
                   "FluxMapResult")),
    ("Elements: stiffness and stresses", ("stiffness", "StiffnessResult")),
    ("What the phases must be", ("fit", "FitResult")),
    ("Bonds: stiffness and fracture", (
        "equilibrium", "fracture", "dynamics", "bond_stiffness", "bond_stress", "EquilibriumResult", "FractureResult",
        "FractureState", "DynamicsResult", "MotionState", "BondStiffnessResult", "BondStressResult")),
    ("Material points: compression", ("compression", "point_stiffness", "CompressionResult", "PointState",
                                      "PointStiffnessResult")),
    ("What results tell", (
        "pore_flood_fill", "stress_pdf", "crack_path", "compression_curve", "collapse_map", "PoreFloodFillResult",
        "StressPDFResult", "CrackPathResult", "CompressionCurveResult", "CollapseMapResult")),
    ("Files", ("read", "read_steps", "write", "convert", "arrays")),
    ("Pictures and ParaView", ("snapshot", "load_plugin", "load_presets", "plugin_path", "use_preset")),
    ("Errors", ("LamellaError", "ParameterError", "InputError", "NoPathError", "OutOfMemoryError", "DivergenceError", "Cancelled")),
)


def signature(function):
    parameters = []
    for parameter in inspect.signature(function).parameters.values():
        text = str(parameter.replace(annotation=inspect.Parameter.empty))
        hint = str(parameter.annotation).strip("'")
        if parameter.name == "self":
            continue
        if parameter.kind is parameter.KEYWORD_ONLY and "*" not in parameters:
            parameters.append("*")
        name, _, default = text.partition("=")
        parameters.append(f"{name}: {hint}" + (f" = {default}" if default else ""))
    head = f"{function.__name__}({', '.join(parameters)})"
    if len(head) > 100:
        head = f"{function.__name__}(\n    " + ",\n    ".join(parameters) + ",\n)"
    return f"{head} -> {inspect.signature(function).return_annotation}"


def one_line(text):
    return re.sub(r"\s+", " ", text.replace("``", "`").replace("|", "\\|")).strip()


def function_text(function):
    return f"```python\n{signature(function)}\n```\n\n```text\n{inspect.getdoc(function)}\n```\n"


def members(kind):
    """Public properties and methods, those of base classes that are no public names included."""
    found = {}
    for base in reversed(kind.__mro__):
        if base.__module__.startswith("lamella"):
            for name, member in vars(base).items():
                if not name.startswith("_") and (isinstance(member, property) or inspect.isfunction(member)):
                    found[name] = member
    return found


def class_text(kind):
    lines = [one_line(inspect.getdoc(kind)), ""]
    rows = []
    for name, member in members(kind).items():
        if isinstance(member, property):
            hint = inspect.signature(member.fget).return_annotation
            hint = hint if isinstance(hint, str) else hint.__name__
            text = inspect.getdoc(member)
        else:
            hint = inspect.signature(member).return_annotation
            text = inspect.getdoc(member)
            name += "(" + ", ".join(p for p in inspect.signature(member).parameters if p != "self") + ")"
        hint = hint.replace("|", "\\|")
        rows.append(f"| `{name}` | `{hint}` | {one_line(text.split(chr(10) * 2)[0])} |")
    if rows:
        lines += ["| | type | |", "|---|---|---|", *rows, ""]
    return "\n".join(lines)


def reference():
    text = BEGIN
    for title, names in SECTIONS:
        text += f"\n## {title}\n"
        for name in names:
            thing = getattr(lamella, name)
            text += f"\n### {name}\n\n" + (class_text(thing) if inspect.isclass(thing) else function_text(thing))
    return text


def check_names():
    listed = [name for _, names in SECTIONS for name in names]
    assert sorted(listed) == sorted(lamella.__all__), set(listed) ^ set(lamella.__all__)


def check_hints(where, function):
    annotations = {name: parameter.annotation for name, parameter in inspect.signature(function).parameters.items()
                   if parameter.annotation is not parameter.empty}
    stated = types.SimpleNamespace(__annotations__={**annotations, "return": inspect.signature(function).return_annotation})
    names = {**vars(lamella._types), **getattr(function, "__wrapped__", function).__globals__}
    hints = typing.get_type_hints(stated, names)  # whose names are known, too
    parameters = [name for name in inspect.signature(function).parameters if name != "self"]
    missing = [name for name in [*parameters, "return"] if name not in hints]
    assert not missing, f"{where} has no type hint for {', '.join(missing)}"


def check_docstring(where, text, parameters=()):
    assert text and text.strip(), f"{where} has no docstring"
    words = set(re.findall(r"\w+", text))
    missing = [name for name in parameters if name not in words]
    assert not missing, f"the docstring of {where} does not name {', '.join(missing)}"


# How docstrings say a shape: numbers of rows and columns, the order of pictures, one for each of something.
SHAPE = re.compile(
    r"#|\bby\b|order of pictures|rows|matrix|[Aa]rray|[Cc]urve|History|[Cc]olumn|by time|node|axis|[Tt]ensor|point|pixel|\bx, y\b"
    r"|[Ss]tructured|3 numbers|3 by 3|volume|Width and height|that bond|Edges|component|eigen|own strains|Normals|one each")
UNITS = re.compile(r"\[[^\]]+\]")
# Arrays of pure numbers: numbers of things, shares, strains, unit vectors, flags, and arrays of any name.
PURE = {"array", "axis", "broken", "broken_so_far", "closed", "collapse_strain", "contacts", "critical_strain", "damage",
        "effective", "energy_defect", "fabric", "field", "grain", "labels", "lumen_share", "mean", "normals", "phase", "rate",
        "ratio", "rattlers", "sizes", "strain"}


def check_classes():
    for name in lamella.__all__:
        kind = getattr(lamella, name)
        if not inspect.isclass(kind):
            continue
        check_docstring(name, inspect.getdoc(kind))
        for member, thing in members(kind).items():
            where = f"{name}.{member}"
            function = thing.fget if isinstance(thing, property) else thing
            check_hints(where, function)
            check_docstring(where, inspect.getdoc(thing))
            if str(inspect.signature(function).return_annotation) in ("Array", "list[Array]"):
                text = inspect.getdoc(thing)
                assert SHAPE.search(text), f"{where} does not say what shape it has: {text}"
                assert member in PURE or UNITS.search(text), f"{where} does not say what unit it has: {text}"


def check_functions():
    for name in lamella.__all__:
        function = getattr(lamella, name)
        if inspect.isclass(function):
            continue
        check_hints(name, function)
        kinds = (inspect.Parameter.VAR_KEYWORD, inspect.Parameter.VAR_POSITIONAL)
        own = [p.name for p in inspect.signature(function).parameters.values() if p.kind not in kinds]
        check_docstring(name, inspect.getdoc(function), own)


def check_classes_of_vtk():
    """Every class that the plugin offers is in the package, and importable by name."""
    for folder in ("vtkLamellaSolversVTK", "vtkLamellaFilters", "vtkLamellaRendering"):
        module = getattr(lamella, folder)
        for name in dir(module):
            if name.startswith("vtk"):
                assert getattr(lamella, name) is getattr(module, name), name


def main():
    path = sys.argv[1]
    with open(path, encoding="utf-8") as file:
        text = file.read()
    head, mark, _ = text.partition(BEGIN)
    assert mark, f"{path} has no line {BEGIN}"
    if "--write" in sys.argv:
        with open(path, "w", encoding="utf-8") as file:
            file.write(head + reference())
        return
    check_names()
    check_functions()
    check_classes()
    check_classes_of_vtk()
    assert text == head + reference(), f"{path} is not the package's: run {sys.argv[0]} {path} --write"
    print("the reference is that of the code")


if __name__ == "__main__":
    main()
