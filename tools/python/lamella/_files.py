"""Files that are written whole or not at all."""

import os
import tempfile

from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter


def write_bytes(content, path):
    handle, part = tempfile.mkstemp(prefix="." + os.path.basename(path), dir=os.path.dirname(os.path.abspath(path)))
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(part, 0o666 & ~mask)
        os.replace(part, path)
    finally:
        if os.path.exists(part):
            os.remove(part)


def write_poly_data(data, path):
    """A .vtp, with its data inline."""
    writer = vtkXMLPolyDataWriter()
    writer.SetInputData(data)
    writer.WriteToOutputStringOn()  # VTK 9.2's writer of inline poly data crashes where a disk is full
    writer.SetDataModeToBinary()
    if writer.Write() != 1:
        raise OSError(f"cannot write {path}")
    write_bytes(writer.GetOutputString().encode("utf-8"), path)
