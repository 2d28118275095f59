"""The flux lines in the example's picture are whole: no row of pixels crosses far fewer of them than those around it.

The tissue has an even number of rows and the picture an odd one, so that every line has a point in the centres of one row's
pixels. Mesa leaves these pixels out where lines are drawn as lines: that row then has 0.6 of the white of the others.
"""

import os
import sys

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

for name in ("heat.png", "vapour.png"):
    reader = vtkPNGReader()
    reader.SetFileName(os.path.join(sys.argv[1], name))
    reader.Update()
    image = reader.GetOutput()
    width, height, _ = image.GetDimensions()
    assert height % 2 == 1, f"{height} rows: the picture shows nothing"
    pixels = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)[::-1, :, :3]
    white = (pixels.min(axis=2) > 240).sum(axis=1)
    data = [row for row in range(height) if 0 < white[row] < width // 2]
    first, last = data[0] + 15, data[0] + (height - 190) - 15  # 190: margins and legend
    for row in range(first, last):
        usual = np.median(white[row - 10 : row + 11])
        assert usual > 20, f"{name}, row {row}: the lines are not there"
        assert white[row] > 0.8 * usual, f"{name}, row {row}: {white[row]} white pixels, {usual:.0f} in the rows around it"
