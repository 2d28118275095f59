"""Makes of files a C++ header of Qt's resources, :/PREFIX/NAME, in version 1 of the format that Qt's rcc writes and that Qt 5 and 6
read: so neither Qt's tools nor its headers are needed to build.

qt_resources.py PREFIX OUT FILE...
"""

import pathlib
import struct
import sys

DIRECTORY = 2


def hash_of(name):
    """Qt's hash of a name, by which entries of a folder are sorted."""
    value = 0
    for character in name:
        value = (value << 4) + ord(character)
        value = (value ^ (value & 0xF0000000) >> 23) & 0x0FFFFFFF
    return value


def resources(prefix, files):
    """The three parts of resources: tree, names and contents."""
    names, contents = b"", b""

    def place_of(name):
        nonlocal names
        place = len(names)
        names += struct.pack(">HI", len(name), hash_of(name)) + name.encode("utf-16-be")
        return place

    # An entry is the place of its name, flags, then of a folder how many entries it has and where they begin, of a file its
    # country, its language (1: any) and the place of its contents.
    tree = struct.pack(">IHII", 0, DIRECTORY, 1, 1) + struct.pack(">IHII", place_of(prefix), DIRECTORY, len(files), 2)
    for path in sorted(files, key=lambda file: hash_of(file.name)):
        tree += struct.pack(">IHHHI", place_of(path.name), 0, 0, 1, len(contents))
        contents += struct.pack(">I", path.stat().st_size) + path.read_bytes()
    return {"tree": tree, "names": names, "contents": contents}


def main():
    prefix, out, *files = sys.argv[1:]
    parts = resources(prefix, [pathlib.Path(file) for file in files])
    text = "".join(f"constexpr unsigned char {name}[] = {{{','.join(map(str, part))}}};\n" for name, part in parts.items())
    pathlib.Path(out).write_text(f"// Made by tools/cmake/qt_resources.py\n{text}", encoding="ascii")


if __name__ == "__main__":
    main()
