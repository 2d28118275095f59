"""lamella.read, write and convert: every pair of formats, on pictures, volumes and points, in one process."""

import gzip
import importlib
import itertools
import os
import tempfile
import unittest

import lamella
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDataArray, vtkPoints, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkMultiBlockDataSet, vtkPolyData
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
from vtkmodules.vtkIOHDF import vtkHDFReader
from vtkmodules.vtkIOPLY import vtkPLYReader
from vtkmodules.vtkIOGeometry import vtkSTLReader

XDMF_READERS = []
for module, reader in (("vtkIOXdmf2", "vtkXdmfReader"), ("vtkIOXdmf3", "vtkXdmf3Reader")):
    try:  # Debian's VTK has no Python for them
        XDMF_READERS.append(getattr(importlib.import_module("vtkmodules." + module), reader))
    except ModuleNotFoundError:
        pass

IMAGES = ("png", "tif", "raw", "mhd", "mha", "nhdr", "nrrd", "vti", "hdf", "csv")
REALS = IMAGES[1:]
POINTS = ("vtp", "vtu", "hdf", "csv")


def counted(shape, dtype):
    """Numbers that hardly two places share; real ones need all their digits."""
    count = np.arange(int(np.prod(shape)), dtype=np.uint64)
    if np.dtype(dtype).kind == "f":
        return (np.sin(count) / 3).astype(dtype).reshape(shape)
    return (count * np.uint64(977) % np.uint64(int(np.iinfo(dtype).max) + 1)).astype(dtype).reshape(shape)


def column(name, values, unit="Pa"):
    array = numpy_to_vtk(values, deep=True)
    array.SetName(name)
    array.GetInformation().Set(vtkDataArray.UNITS_LABEL(), unit)
    return array


def with_fields(data):
    texts = vtkStringArray()
    texts.SetName("who")
    for text in ('Grün & "quoted"', "two"):
        texts.InsertNextValue(text)
    data.GetFieldData().AddArray(texts)
    data.GetFieldData().AddArray(column("strain", np.array([0.1, 1 / 3])))
    return data


def image(shape, dtype, tail=()):
    """An image with an array, at a place of its own."""
    data = vtkImageData()
    data.SetDimensions((*shape[::-1], 1)[:3])
    data.SetSpacing(4e-6, 5e-6, 6e-6)
    data.SetOrigin(0.1, 1 / 3, -7)
    data.GetPointData().AddArray(column("grain", counted((int(np.prod(shape)), *tail), dtype)))
    return with_fields(data)


def points():
    data = vtkPolyData()
    places, vertices = vtkPoints(), vtkCellArray()
    places.SetDataTypeToDouble()
    for i in range(20):
        vertices.InsertNextCell(1, [places.InsertNextPoint(i / 3, i * i / 7, -i)])
    data.SetPoints(places)
    data.SetVerts(vertices)
    data.GetPointData().AddArray(column("radius", counted(20, "f8")))
    data.GetPointData().AddArray(column("force", counted((20, 3), "f4"), "N"))
    data.GetPointData().AddArray(column("contacts", counted(20, "i4")))
    return with_fields(data)


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def same(self, back, data, what):
        """To the bit, with place, types, units and field data."""
        if isinstance(data, vtkImageData):
            for get in ("GetDimensions", "GetSpacing", "GetOrigin"):
                self.assertEqual(getattr(back, get)(), getattr(data, get)(), what)
            self.assertTrue(back.GetDirectionMatrix().IsIdentity(), what)
        else:
            self.assertEqual(back.GetNumberOfCells(), data.GetNumberOfCells(), what)
            np.testing.assert_array_equal(*([one.GetPoint(i) for i in range(20)] for one in (back, data)))
        self.assertEqual(back.GetPointData().GetNumberOfArrays(), data.GetPointData().GetNumberOfArrays(), what)
        for name, values in lamella.arrays(data).items():
            found = lamella.arrays(back)[name]
            self.assertEqual((found.dtype, found.tobytes()), (values.dtype, values.tobytes()), f"{what}: {name}")
            units = [one.GetPointData().GetArray(name).GetInformation().Get(vtkDataArray.UNITS_LABEL()) for one in (back, data)]
            self.assertEqual(units[0], units[1], what)
        fields = back.GetFieldData()
        self.assertEqual([fields.GetAbstractArray("who").GetValue(i) for i in range(2)], ['Grün & "quoted"', "two"], what)
        self.assertEqual([fields.GetArray("strain").GetValue(i) for i in range(2)], [0.1, 1 / 3], what)
        self.assertIn("lamella", fields.GetAbstractArray("provenance").GetValue(0), what)

    def through_every_pair(self, data, formats, slices=False):
        def file(folder, ending):
            os.makedirs(self.path(folder), exist_ok=True)
            return self.path(folder, ("v_%02d." if slices and ending == "png" else "v.") + ending)

        for ending in formats:
            lamella.write(data, file(ending, ending))
        for before, after in itertools.product(formats, repeat=2):
            into = file(f"{before}-{after}", after)
            lamella.convert(file(before, before), into)
            self.same(lamella.read(into), data, f"{before} to {after}")


class RoundTrips(Files):
    def test_pictures(self):
        for dtype in ("u1", "u2"):
            with self.subTest(dtype):
                self.folder = tempfile.mkdtemp(dir=self.folder)
                self.through_every_pair(image((5, 7), dtype), IMAGES)

    def test_pictures_of_real_numbers(self):
        self.through_every_pair(image((5, 7), "f4"), REALS)

    def test_volumes(self):
        self.through_every_pair(image((5, 3, 4), "u2"), IMAGES, slices=True)

    def test_volumes_of_real_numbers(self):
        self.through_every_pair(image((5, 3, 4), "f8"), REALS)

    def test_volumes_of_vectors(self):
        self.through_every_pair(image((5, 3, 4), "f4", (3,)), [name for name in REALS if name != "tif"])

    def test_colours(self):
        self.through_every_pair(image((5, 7), "u1", (3,)), IMAGES)

    def test_volumes_of_whole_numbers_of_any_type(self):
        for dtype in ("i1", "i2", "i4", "u4", "i8"):
            with self.subTest(dtype):
                self.folder = tempfile.mkdtemp(dir=self.folder)
                self.through_every_pair(image((2, 3, 4), dtype), ["tif", "raw", "mha", "nrrd", "vti", "hdf", "csv"])

    def test_points(self):
        self.through_every_pair(points(), POINTS)

    def test_flat_volumes(self):
        flat = image((5, 1, 4), "f8")
        self.through_every_pair(flat, ["raw", "mha", "nrrd", "vti", "hdf"])


class VtkHdf(Files):
    def test_pictures_are_read_by_paraview(self):
        for shape in ((5, 7), (5, 1, 7)):  # flat along z, and along y
            data = image(shape, "f4")
            data.GetPointData().AddArray(column("flux", counted((35, 3), "f8")))
            path = self.path(f"picture{len(shape)}.hdf")
            lamella.write(data, path)
            reader = vtkHDFReader()
            reader.SetFileName(path)
            reader.Update()
            back = reader.GetOutputDataObject(0)
            self.assertEqual(sorted(back.GetDimensions()), sorted(data.GetDimensions()))
            self.assertEqual(back.GetDimensions()[0], 1)
            for name in ("grain", "flux"):  # in the order of VTK
                before, after = (vtk_to_numpy(one.GetPointData().GetArray(name)) for one in (data, back))
                self.assertEqual((after.dtype, after.tobytes()), (before.dtype, before.tobytes()))
            # Each point is where it was, once a copy follows the direction; sums of three products round.
            copy = vtkImageData()
            copy.ShallowCopy(back)
            places = [[one.GetPoint(i) for i in range(35)] for one in (copy, data)]
            np.testing.assert_allclose(*places, rtol=1e-14, atol=1e-20)

    def test_what_its_reader_cannot_take(self):
        with self.assertRaisesRegex(lamella.LamellaError, "single line of points.*\\.vti"):
            lamella.write(image((1, 7), "u1"), self.path("x.hdf"))
        self.assertEqual(os.listdir(self.folder), [])


@unittest.skipUnless(XDMF_READERS, "this VTK reads no XDMF")
class Xdmf(Files):
    READERS = XDMF_READERS

    def read(self, reader_class, path, time=None):
        reader = self.reader = reader_class()  # Xdmf3 keeps the memory of its arrays
        reader.SetFileName(path)
        reader.UpdateInformation()
        if time is not None:
            self.assertEqual(reader.GetOutputInformation(0).Get(Pipeline.TIME_STEPS()), (0.25, 1.5))
            reader.UpdateTimeStep(time)
        reader.Update()
        return reader.GetOutputDataObject(0)

    def test_images_of_all_types_at_their_place(self):
        for shape in ((3, 4, 5), (5, 7), (5, 1, 7), (5, 4, 1)):
            data = image(shape, "f8")
            count = int(np.prod(shape))
            for dtype in ("i1", "u1", "i2", "u2", "i4", "u4", "f4"):
                data.GetPointData().AddArray(column(f"{dtype} <&>", counted(count, dtype)))
            for dtype in ("i8", "u8"):
                data.GetPointData().AddArray(column(dtype, np.arange(count, dtype=dtype) << 50))
            for components in (2, 3, 6, 9):
                data.GetPointData().AddArray(column(f"of {components}", counted((count, components), "f4")))
            path = self.path("x%s.xdmf" % "_".join(map(str, shape)))
            self.assertEqual(lamella.write(data, path), [path.replace(".xdmf", ".h5"), path])
            for reader in self.READERS:
                back = self.read(reader, path)
                self.assertEqual(back.GetDimensions(), data.GetDimensions())
                np.testing.assert_allclose(back.GetSpacing(), data.GetSpacing(), rtol=1e-14)
                np.testing.assert_allclose(back.GetOrigin(), data.GetOrigin(), rtol=1e-14)
                for i in range(data.GetPointData().GetNumberOfArrays()):
                    array = data.GetPointData().GetArray(i)
                    before, after = vtk_to_numpy(array), vtk_to_numpy(back.GetPointData().GetArray(array.GetName()))
                    what = f"{reader.__name__}, {shape}, {array.GetName()}"
                    np.testing.assert_array_equal(after.reshape(before.shape), before, what)
                    self.assertEqual(after.dtype.itemsize, before.dtype.itemsize, what)

    def test_steps(self):
        for i, time in enumerate((0.25, 1.5)):
            data = image((2, 3, 4), "f8")
            data.GetFieldData().AddArray(column("TimeValue", np.array([time])))
            data.GetPointData().GetArray(0).SetValue(0, 7 + i)
            lamella.write(data, self.path(f"s_{i}.vti"))
        files = lamella.convert(self.path("s_*.vti"), self.path("t.xdmf"))
        self.assertEqual([os.path.basename(name) for name in files], ["t_000.h5", "t_001.h5", "t.xdmf"])
        for reader in self.READERS:
            for i, time in enumerate((0.25, 1.5)):
                back = self.read(reader, self.path("t.xdmf"), time)
                self.assertEqual(back.GetPointData().GetArray("grain").GetValue(0), 7 + i, reader.__name__)

    def test_what_it_has_no_place_for(self):
        with self.assertRaisesRegex(lamella.LamellaError, "20 points have|holds points with 20 cells"):
            lamella.write(points(), self.path("x.xdmf"))
        turned = image((2, 3, 4), "f8")
        turned.SetDirectionMatrix(0, 1, 0, -1, 0, 0, 0, 0, 1)
        with self.assertRaisesRegex(lamella.LamellaError, "axes of the image are not those of space"):
            lamella.write(turned, self.path("x.xdmf"))
        self.assertEqual(os.listdir(self.folder), [])


class Surfaces(Files):
    def test_stl_and_ply_hold_the_same_triangles(self):
        sample = lamella.spheres(size=(14, 14, 14), spacing=1e-6)
        for reader, name in ((vtkSTLReader(), "s.stl"), (vtkPLYReader(), "s.ply")):
            path = self.path(name)
            self.assertEqual(lamella.write(sample, path, phase="inclusion"), [path, path + ".json"])
            reader.SetFileName(path)
            reader.Update()
            back = reader.GetOutput()
            self.assertGreater(back.GetNumberOfCells(), 500)
            if name == "s.stl":
                first = back
            self.assertEqual(back.GetNumberOfPoints(), first.GetNumberOfPoints())
            self.assertEqual(back.GetNumberOfCells(), first.GetNumberOfCells())
            np.testing.assert_allclose(back.GetBounds(), first.GetBounds(), rtol=1e-7)

    def test_axes_of_a_left_hand_turn_no_normal_round(self):
        volume = np.zeros((5, 6, 7), np.uint8)
        volume[1:4, 1:4, 1:4] = 1
        lamella.write(volume, self.path("v.vti"), spacing=2e-6)
        data = lamella.read(self.path("v.vti"))
        data.SetDirectionMatrix(0, 1, 0, 1, 0, 0, 0, 0, 1)
        lamella.write(data, self.path("s.vtp"), phase=["1"])
        surface = lamella.read(self.path("s.vtp"))
        triangles = np.array([[surface.GetCell(i).GetPoints().GetPoint(k) for k in range(3)] for i in range(surface.GetNumberOfCells())])
        enclosed = np.einsum("ij,ij->", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2])) / 6
        self.assertAlmostEqual(enclosed / 8e-18, 27 - 24 / 8 - 8 * 5 / 48, 3)


class Arrays(Files):
    def test_numpy_arrays_go_through_files(self):
        picture = np.arange(35, dtype=np.uint16).reshape(5, 7)
        self.assertEqual(lamella.write(picture, self.path("a.png"), spacing=5e-7, name="grain"), [self.path("a.png")])
        data = lamella.read(self.path("a.png"))
        self.assertEqual(data.GetSpacing()[:2], (5e-7, 5e-7))
        np.testing.assert_array_equal(lamella.arrays(data)["grain"], picture)
        volume = counted((2, 3, 4), "f8")
        lamella.write(volume, self.path("v.nrrd"))
        np.testing.assert_array_equal(lamella.arrays(lamella.read(self.path("v.nrrd")))["values"], volume)
        colours = counted((5, 7, 3), "u1")
        lamella.write(colours, self.path("c.png"), vectors=True)
        np.testing.assert_array_equal(next(iter(lamella.arrays(lamella.read(self.path("c.png"))).values())), colours)

    def test_samples_and_results(self):
        tissue = lamella.softwood(size=(40, 30), spacing=5e-7, seed=3)
        lamella.write(tissue, self.path("t.tif"))
        back = lamella.read(self.path("t.tif"))
        np.testing.assert_array_equal(lamella.arrays(back)["phase"], tissue.phase)
        result = lamella.diffusion(back, {"wall": 1, "lumen": 0.1}, "x")
        self.assertAlmostEqual(result.effective[0, 0], lamella.diffusion(tissue, {"wall": 1, "lumen": 0.1}, "x").effective[0, 0], 12)
        lamella.write(result, self.path("t.csv"), array="temperature")
        self.assertEqual(list(lamella.arrays(lamella.read(self.path("t.csv")))), ["temperature"])

    def test_types_and_ranges(self):
        values = np.linspace(0, 1, 24).reshape(4, 6)
        lamella.write(values, self.path("a.png"), range=(0, 1))
        greys = next(iter(lamella.arrays(lamella.read(self.path("a.png"))).values()))
        np.testing.assert_array_equal(greys, np.floor(values * 255 + 0.5))
        lamella.write(values, self.path("a.raw"), type="f32", lossy=True)
        self.assertEqual(np.fromfile(self.path("a.raw"), "f4").tobytes(), values[::-1].astype("f4").tobytes())

    def test_raw_volumes(self):
        values = counted((2, 3, 4), ">i2")
        values.tofile(self.path("v.raw"))
        raw = {"raw_size": (4, 3, 2), "raw_type": "i16", "raw_order": "big", "pixel_size": 1e-6}
        data = lamella.read(self.path("v.raw"), **raw)
        np.testing.assert_array_equal(lamella.arrays(data)["grey"], values)
        self.assertEqual(lamella.convert(self.path("v.raw"), self.path("v.vti"), **raw), [self.path("v.vti")])
        np.testing.assert_array_equal(lamella.arrays(lamella.read(self.path("v.vti")))["grey"], values)
        self.assertEqual(lamella.read(self.path("v.vti")).GetSpacing(), (1e-6,) * 3)


class Series(Files):
    def test_steps(self):
        for i in (0, 1, 2):
            data = image((2, 3, 4), "f8")
            data.GetFieldData().AddArray(column("TimeValue", np.array([0.1 * i])))
            data.GetPointData().GetArray(0).SetValue(0, i)
            lamella.write(data, self.path(f"s_{i}.vti"))
        files = lamella.convert(self.path("s_*.vti"), self.path("t.pvd"))
        self.assertEqual([os.path.basename(name) for name in files], ["t_000.vti", "t_001.vti", "t_002.vti", "t.pvd"])
        times = []
        for number, (time, data) in enumerate(lamella.read_steps(self.path("t.pvd"))):
            times.append(time)
            self.assertEqual(lamella.arrays(data)["grain"][0, 0, 0], number)
        self.assertEqual(times, [0, 0.1, 0.2])
        with self.assertRaisesRegex(lamella.LamellaError, r"is a series of 3 steps \(choose one with step NUMBER"):
            lamella.read(self.path("t.pvd"))
        self.assertEqual(lamella.arrays(lamella.read(self.path("t.pvd"), step=2))["grain"][0, 0, 0], 2)
        with self.assertRaisesRegex(lamella.LamellaError, "step 3 is none of the 3 steps"):
            lamella.read(self.path("t.pvd"), step=3)


class Mistakes(Files):
    def test_they_are_told_in_words_of_python(self):
        data = image((4, 6), "f8")
        data.GetPointData().AddArray(column("more", counted(24, "f8")))
        with self.assertRaisesRegex(lamella.LamellaError, "holds 2 arrays .* takes one .choose one with array NAME"):
            lamella.write(data, self.path("a.png"))
        with self.assertRaisesRegex(lamella.LamellaError, "range LOW,HIGH"):
            lamella.write(data, self.path("a.png"), array="more")
        with self.assertRaisesRegex(lamella.LamellaError, "did you mean 'more'"):
            lamella.write(data, self.path("a.vti"), array="mere")
        with self.assertRaisesRegex(lamella.LamellaError, "there is no file"):
            lamella.read(self.path("nothing.vti"))
        with self.assertRaisesRegex(lamella.LamellaError, "has no ending of a format that is known"):
            lamella.write(data, self.path("a.xyz"))
        with self.assertRaisesRegex(lamella.LamellaError, "a vtkMultiBlockDataSet cannot be written"):
            lamella.write(vtkMultiBlockDataSet(), self.path("a.vti"))
        with self.assertRaisesRegex(ValueError, "neither a picture nor a volume"):
            lamella.write(np.zeros(3), self.path("a.vti"))
        with self.assertRaisesRegex(lamella.ParameterError, "pixel size -1 is not above 0"):
            lamella.read(self.path("a.png"), pixel_size=-1)
        self.assertEqual(os.listdir(self.folder), [])

    def test_damaged_files(self):
        for ending in ("vti", "vtp", "vtu", "hdf", "png", "tif", "mha", "nrrd", "csv", "pvd"):
            for content in (b"", b"not at all", b"<VTKFile type='ImageData'>", bytes(300)):
                with open(self.path("bad." + ending), "wb") as file:
                    file.write(content)
                with self.assertRaises(lamella.LamellaError, msg=f"{ending}: {content[:20]}"):
                    lamella.read(self.path("bad." + ending))

    def test_a_volume_that_ends_in_its_third_slab(self):
        head = b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 512 512 256\nencoding: gzip\n\n"
        with open(self.path("v.nrrd"), "wb") as file:
            file.write(head + gzip.compress(bytes(40 * 2**20)))
        for ending in ("vti", "hdf", "mha", "tif"):
            with self.assertRaisesRegex(lamella.LamellaError, "v.nrrd. (is truncated: its packed values end|has .* packed bytes)"):
                lamella.convert(self.path("v.nrrd"), self.path("x." + ending))
        self.assertEqual(os.listdir(self.folder), ["v.nrrd"])

    def test_nothing_is_overwritten_without_leave(self):
        lamella.write(np.zeros((3, 3)), self.path("a.vti"))
        with self.assertRaisesRegex(FileExistsError, "'.*a.vti' exists already.*overwrite"):
            lamella.write(np.ones((3, 3)), self.path("a.vti"))
        self.assertEqual(lamella.arrays(lamella.read(self.path("a.vti")))["values"].max(), 0)
        lamella.write(np.ones((3, 3)), self.path("a.vti"), overwrite=True)
        self.assertEqual(lamella.arrays(lamella.read(self.path("a.vti")))["values"].max(), 1)

    def test_cancelling_leaves_nothing(self):
        np.zeros(2**25, np.uint8).tofile(self.path("v_512x256x256_u8.raw"))
        shares = []

        def stop(share, _):
            shares.append(share)
            return share < 0.4

        def fail(*_):
            raise KeyError("mine")

        for ending in ("vti", "hdf", "mha"):
            with self.assertRaises(lamella.Cancelled):
                lamella.convert(self.path("v_512x256x256_u8.raw"), self.path("x." + ending), progress=stop)
            with self.assertRaisesRegex(KeyError, "mine"):
                lamella.convert(self.path("v_512x256x256_u8.raw"), self.path("x." + ending), progress=fail)
        self.assertTrue(all(0 <= share <= 1 for share in shares))
        self.assertEqual(os.listdir(self.folder), ["v_512x256x256_u8.raw"])


if __name__ == "__main__":
    unittest.main(argv=["files"], verbosity=2)
