"""Makes what follows from the settings that the headers of the VTK classes declare (headers.py).

make.py panels LAYOUTS OUT HEADER...   ParaView's panels, a server manager XML each class that has a layout
make.py tables OUT HEADER... -- OTHER...  what classes check their settings by, of those of a module; others they derive from
make.py python OUT HEADER...            the keywords of the Python package
make.py pages SOURCES                  the tables in the pages of filters, where they stand
"""

import pathlib
import re
import sys
import xml.etree.ElementTree as ElementTree

import pages
import panels
import python
import tables
from headers import Declarations, HeaderError


def make_panels(layouts, out, *headers):
    declarations = Declarations(headers)
    found, chart = panels.read_layouts(layouts)
    for name in found:
        if not declarations.classes[name].abstract:
            panels.write(declarations, found, chart, name, pathlib.Path(out) / f"{name[3:]}.xml")


def make_tables(out, *headers):
    split = headers.index("--") if "--" in headers else len(headers)
    tables.write(Declarations([*headers[:split], *headers[split + 1:]]), headers[:split], out)


def make_python(out, *headers):
    python.write(Declarations(headers), out)


def headers_of(sources):
    """The headers that declare settings, of a tree of sources."""
    folders = ("solvers/vtk", "solvers/vtk/*", "filters", "filters/rendering", "tools/vtk")
    found = [path for folder in folders for path in sorted(pathlib.Path(sources).glob(folder + "/vtk*.h"))]
    return [path for path in found if re.search(r"^class \w+_EXPORT \w+ : public \w+Algorithm|^class \w+_EXPORT vtk(Snapshot|VTKHDFWriter) ",
                                                path.read_text(encoding="utf-8"), re.MULTILINE)]


def make_pages(sources):
    pages.write(Declarations(headers_of(sources)), pathlib.Path(sources) / "docs/filters")


def main():
    try:
        {"panels": make_panels, "tables": make_tables, "python": make_python, "pages": make_pages}[sys.argv[1]](*sys.argv[2:])
    except (HeaderError, ElementTree.ParseError) as error:
        sys.exit(f"error: {error}")


if __name__ == "__main__":
    main()
