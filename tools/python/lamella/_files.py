"""Files that are written whole or not at all."""

import contextlib
import os
import tempfile

from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter


def new_path(path, overwrite):
    """The path as a text; an error where there is a file already that is not to be replaced."""
    path = os.fspath(path)
    if os.path.exists(path) and not overwrite:
        raise FileExistsError(f"{path} exists; say overwrite=True to replace it")
    return path


@contextlib.contextmanager
def replacing(path):
    """A name beside ``path`` to write to: what is there at the end takes the path's place, and goes where writing failed."""
    # VTK writes nothing, and says it did, where a name ends with an underscore, as random ones may
    handle, part = tempfile.mkstemp(prefix="." + os.path.basename(path), suffix=".part", dir=os.path.dirname(os.path.abspath(path)))
    os.close(handle)
    try:
        yield part
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(part, 0o666 & ~mask)
        os.replace(part, path)
    finally:
        if os.path.exists(part):
            os.remove(part)


def write_bytes(content, path):
    with replacing(path) as part, open(part, "wb") as file:
        file.write(content)


def write_poly_data(data, path):
    """A .vtp, with its data inline."""
    writer = vtkXMLPolyDataWriter()
    writer.SetInputData(data)
    writer.WriteToOutputStringOn()  # VTK 9.2's writer of inline poly data crashes where a disk is full
    writer.SetDataModeToBinary()
    if writer.Write() != 1:
        raise OSError(f"cannot write {path}")
    write_bytes(writer.GetOutputString().encode("utf-8"), path)


def save_poly_data(data, path, overwrite):
    """The same where there is no file yet, or it may be replaced; returns the path."""
    path = new_path(path, overwrite)
    write_poly_data(data, path)
    return path
