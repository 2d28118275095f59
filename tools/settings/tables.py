"""Makes the tables by which a class checks its settings (solvers/vtk/shared/Settings.h): C++ of one module, of what its headers declare."""

import itertools
import json
import math
import pathlib
import re

from pages import number as plain
from python import axes

HEAD = """// Made from the headers of these classes.
#include "SettingTable.h"

"""
HELPERS = """
#include <cmath>
#include <limits>
#include <type_traits>

namespace
{

using lamella::Setting;
using lamella::SettingValue;
using Kind = Setting::Kind;
using Type = Setting::Type;

constexpr double inf = std::numeric_limits<double>::infinity();
[[maybe_unused]] constexpr double nan = std::numeric_limits<double>::quiet_NaN();

template <typename T>
std::vector<double> numbers(T value)
{
  return { static_cast<double>(value) };
}

template <typename T>
std::vector<double> numbers(const T* values, std::size_t count)
{
  return { values, values + count };
}

/// What a setter takes, of what it is given.
struct Given
{
  const std::vector<SettingValue>& values;
  [[nodiscard]] bool on(std::size_t i) const { return std::get<double>(values[i]) != 0; }
  template <typename T>
  [[nodiscard]] T number(std::size_t i) const
  {
    const double value = std::get<double>(values[i]);
    if (std::is_integral_v<T> && !(std::fabs(value) < std::ldexp(1.0, std::numeric_limits<T>::digits)))
    {
      lamella::refuseSize(value);
    }
    return static_cast<T>(value);
  }
  [[nodiscard]] const char* text(std::size_t i) const { return std::get<std::string>(values[i]).c_str(); }
};

"""


def number(value):
    if math.isinf(value):
        return "-inf" if value < 0 else "inf"
    return repr(float(value))


def quoted(text):
    return json.dumps(text, ensure_ascii=False)


TAKEN = {"switch": "given.on({})", "number": "given.number<double>({})", "text": "given.text({})"}


def call(name, setting):
    """One call of the setter."""
    taken = []
    for i, (kind, whole) in enumerate(zip(setting.types, setting.wholes or setting.types)):
        taken.append(f"given.number<{whole}>({i})" if kind == "whole" else TAKEN[kind].format(i))
    return f"static_cast<{name}*>(object)->{setting.setter}({', '.join(taken)})"


def condition(declarations, name, setting):
    """The word of another setting, what it has to be for this one to count, and how people say so."""
    other = declarations.other(name, setting) if setting.when else None
    return f"{quoted(other[0].word)}, {{ {', '.join(map(str, other[1]))} }}, {quoted(other[2])}" if other else '"", {}, ""'


def entry(declarations, name, setting):
    limits = setting.range
    choices = ", ".join(f"{{ {quoted(choice.word)}, {choice.value} }}" for choice in setting.choices)
    names = ", ".join(f"{{ {quoted(word)}, {value} }}" for value, word in setting.names)
    several = len(setting.types) > 1
    parts = ", ".join(map(quoted, setting.columns))
    ends = f"{str(limits.low_open).lower()}, {str(limits.high_open).lower()}"
    kind = "Axes" if axes(setting) else setting.kind.capitalize()
    read = f"static_cast<{name}*>(object)->{setting.getter}()" + (f", {len(setting.types)}" if several else "")
    values = f"[](vtkObject* object) {{ return numbers({read}); }}" if checked(setting) else "nullptr"
    words = ", ".join(quoted(text) for text in (setting.unit, setting.group, setting.text, standard(setting)))
    return (f"    {{ {quoted(setting.word)}, {quoted(setting.off)}, {quoted(setting.off_text)}, Kind::{kind}, {{ {', '.join('Type::' + t.capitalize() for t in setting.types)} }}, "
            f"{number(limits.low)}, {number(limits.high)}, {ends}, {'nan' if setting.unset is None else number(setting.unset)}, {'nan' if setting.rest is None else number(setting.rest)}, {{ {', '.join(map(str, setting.flat))} }}, {{ {choices} }}, {{ {names} }}, {str(setting.colour).lower()}, {{ {parts} }},\n      {words},\n"
            f"      {condition(declarations, name, setting)}, {quoted(setting.uncertainty)},\n      {values},\n"
            f"      [](vtkObject* object, const std::vector<SettingValue>& values)\n"
            f"      {{\n        const Given given{{ values }};\n        {call(name, setting)};\n      }} }},\n")


def length(value):
    """Metres as people write those of micrographs: 36um."""
    return f"{value * 1e6:g}um" if 1e-7 <= abs(value) < 1e-3 else plain(value)


def standard(setting):
    """The default, as it is written in a command; empty where nothing is."""
    values = setting.default if isinstance(setting.default, list) else [setting.default]
    if setting.kind == "list" or setting.default in ("", None) or (setting.unset is not None and set(values) == {setting.unset}):
        return ""
    if setting.choices:
        return next(choice.word for choice in setting.choices if choice.value == setting.default)
    if axes(setting):
        return "".join(axis for axis, flag in zip("xyz", setting.default) if flag)
    if setting.kind == "switch":
        return ""
    if setting.colour:
        return "#" + "".join(f"{round(255 * part):02x}" for part in setting.default)
    for value, name in setting.names:
        if int(value) == setting.default:
            return name
    units = [setting.unit or re.sub(r".*\[(.*)\]", r"\1", column) for column in setting.columns or [""]]
    return ",".join(length(float(f"{value:.12g}")) if unit == "m" else plain(value)
                    for value, unit in zip(values, itertools.cycle(units))) if setting.kind in ("whole", "number", "vector") else setting.default


def checked(setting):
    """Words hold what they hold; what is listed is looked at by those who take it."""
    return setting.getter and setting.kind in ("switch", "whole", "number", "choice", "vector") and set(setting.types) <= {"switch", "whole", "number"}


def write(declarations, headers, path):
    """@param headers of the module's classes"""
    names = [name for name in declarations.classes if not declarations.classes[name].abstract
             and any(pathlib.Path(header).stem == name for header in headers)]
    text = HEAD + "".join(f'#include "{name}.h"\n' for name in names) + HELPERS
    for name in names:
        text += f"\nconst std::vector<Setting>& of_{name}()\n{{\n  static const std::vector<Setting> table = {{\n"
        text += "".join(entry(declarations, name, setting) for setting in declarations.settings(name))
        text += "  };\n  return table;\n}\n"
    text += "\nconst lamella::SettingTables tables({\n" + "".join(f"  {{ {quoted(name)}, &of_{name} }},\n" for name in names) + "});\n\n}\n"
    pathlib.Path(path).write_text(text, encoding="utf-8")
