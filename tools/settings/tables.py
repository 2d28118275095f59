"""Makes the tables by which a class checks its settings (solvers/vtk/Settings.h): C++ of one module, of what its headers declare."""

import json
import math
import pathlib

HEAD = """// Made from the headers of these classes.
#include "Settings.h"

"""
HELPERS = """
#include <limits>

namespace
{

using lamella::Setting;

constexpr double inf = std::numeric_limits<double>::infinity();

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

"""


def number(value):
    if math.isinf(value):
        return "-inf" if value < 0 else "inf"
    return repr(float(value))


def quoted(text):
    return json.dumps(text, ensure_ascii=False)


def entry(name, setting):
    limits = setting.range
    choices = ", ".join(f"{{ {quoted(choice.word)}, {choice.value} }}" for choice in setting.choices)
    several = len(setting.types) > 1
    parts = ", ".join(map(quoted, setting.columns)) if several else ""
    call = f"static_cast<{name}*>(object)->{setting.getter}()" + (f", {len(setting.types)}" if several else "")
    ends = f"{str(limits.low_open).lower()}, {str(limits.high_open).lower()}"
    return (f"    {{ {quoted(setting.word.replace('-', ' '))}, {number(limits.low)}, {number(limits.high)}, {ends}, {{ {choices} }}, {{ {parts} }},\n"
            f"      [](vtkObject* object) {{ return numbers({call}); }} }},\n")


def checked(setting):
    """Switches and words hold what they hold; what is listed is looked at by those who take it."""
    return setting.getter and setting.kind in ("whole", "number", "choice", "vector") and set(setting.types) <= {"whole", "number"}


def write(declarations, headers, path):
    """@param headers of the module's classes"""
    names = [name for name in declarations.classes if not declarations.classes[name].abstract
             and any(pathlib.Path(header).stem == name for header in headers)]
    text = HEAD + "".join(f'#include "{name}.h"\n' for name in names) + HELPERS
    for name in names:
        text += f"\nconst std::vector<Setting>& of_{name}()\n{{\n  static const std::vector<Setting> table = {{\n"
        text += "".join(entry(name, setting) for setting in declarations.settings(name) if checked(setting))
        text += "  };\n  return table;\n}\n"
    text += "\nconst lamella::SettingTables tables({\n" + "".join(f"  {{ {quoted(name)}, &of_{name} }},\n" for name in names) + "});\n\n}\n"
    pathlib.Path(path).write_text(text, encoding="utf-8")
