"""The libraries that come with ours: few, and one HDF5 in a process.

  check_libraries.py LIBRARY MOST [OTHER...]

LIBRARY (the numerics) brings fewer than MOST shared libraries along, those apart that MPI brings (11 with Open MPI 4 of
Debian 12, 24 with Open MPI 5 of Debian 13); it and all OTHERs have one libhdf5 each, the same, and
none of what OpenCV's imgcodecs brings.
"""

import re
import subprocess
import sys

UNWANTED = ("gdal", "poppler", "odbc", "opencv_imgcodecs", "gdcm")


def libraries(path):
    done = subprocess.run(["ldd", path], check=True, capture_output=True, text=True)
    missing = re.findall(r"(\S+) => not found", done.stdout)
    if missing:
        sys.exit(f"{path} does not find {', '.join(missing)}")
    return dict(re.findall(r"(\S+) => (/\S+)", done.stdout))


def main():
    numerics, most, *others = sys.argv[1:]
    faults = []
    hdf5 = set()
    for path in (numerics, *others):
        names = libraries(path)
        hdf5 |= {name for name in names if re.match(r"libhdf5(_[a-z]+)?\.so", name)}
        found = [name for name in names if any(word in name for word in UNWANTED)]
        if found:
            faults.append(f"{path} brings {', '.join(found)} along")
        mpi = {name for library, file in names.items() if library.startswith("libmpi.so") for name in libraries(file)}
        own = len(set(names) - mpi)
        print(f"{path}: {len(names)} libraries, {own} of them not MPI's")
        if path == numerics and own >= int(most):
            faults.append(f"{path} brings {own} libraries along that are not MPI's; fewer than {most} are wanted")
    if len(hdf5) != 1:
        faults.append(f"one HDF5 is wanted, and there are {len(hdf5)}: {', '.join(sorted(hdf5))}")
    sys.exit("\n".join(faults) or 0)


main()
