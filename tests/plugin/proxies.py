"""The plugin's sources and filters through paraview.simple: names, defaults, documentation, numbers."""

import os
import tempfile
import unittest

import lamella
import numpy as np
import paraview.simple as pv
from paraview import servermanager, smstate

lamella.load_plugin()


def field(source, name):
    array = servermanager.Fetch(source).GetFieldData().GetArray(name)
    return [array.GetTuple1(i) for i in range(array.GetNumberOfTuples())]


NAMES = set(globals())


class Proxies(unittest.TestCase):
    def tearDown(self):
        for source in reversed(list(pv.GetSources().values())):  # a new connection takes 0.4 s
            pv.Delete(source)
        for name in set(globals()) - NAMES - {"NAMES", "Proxies"}:
            del globals()[name]  # sum, min and the like: a ProgrammableSource puts its arrays' own in their place

    def test_defaults_are_those_of_the_classes(self):
        # Of the XML: tests/plugin/panels.py. Here: nothing that ParaView does when it makes a proxy changes them.
        makers = [name for name in dir(pv) if hasattr(lamella, "vtk" + name)]
        self.assertGreater(len(makers), 20)
        for maker in makers:
            proxy = getattr(pv, maker)()
            fresh = getattr(lamella, "vtk" + maker)()
            for name in proxy.ListProperties():
                value = proxy.SMProxy.GetProperty(name)
                getter = "G" + (value.GetCommand() or "")[1:]
                plain = not value.GetInformationOnly() and value.IsA("vtkSMVectorProperty") and not value.GetRepeatable()
                if plain and hasattr(fresh, getter) and getter.startswith("Get"):
                    shown = tuple(value.GetElement(i) for i in range(value.GetNumberOfElements()))
                    own = getattr(fresh, getter)()
                    own = tuple(own) if isinstance(own, (tuple, list)) else ("" if own is None else own,)
                    if (maker, name) not in (("SteadyDiffusion", "EstimateError"), ("SteadyDiffusion", "Direction")):  # @panel of the header
                        self.assertEqual(shown, own, f"{maker}.{name}")

    def test_defaults_run(self):
        tissue = pv.MicrostructureSource(Size=[90, 80, 1])
        heat = pv.SteadyDiffusion(Input=tissue)  # heat in wood, along x
        flux = pv.FluxMap(Input=heat)
        flux.UpdatePipeline()
        expected = lamella.diffusion(lamella.softwood(size=(90, 80)), {"wall": 1, "lumen": 0.023}, "x")
        self.assertAlmostEqual(field(heat, "effective_conductivity")[0], expected.effective[0, 0], places=7)
        heat.SMProxy.UpdatePropertyInformation()
        self.assertAlmostEqual(heat.GetPropertyValue("EffectiveConductivity")[0], expected.effective[0, 0], places=7)
        tensors = pv.SteadyDiffusion(Input=tissue, Conductivities=["lumen", "0.023"], ConductivityTensors=["wall", "1 0.4 0.4 0.2 0 0"])
        self.assertAlmostEqual(field(tensors, "effective_conductivity")[0],
                               lamella.diffusion(lamella.softwood(size=(90, 80)), {"wall": [[1, 0.2], [0.2, 0.4]], "lumen": 0.023}, "x").effective[0, 0], places=7)
        self.assertEqual(servermanager.Fetch(flux, idx=1).GetNumberOfLines(), 60)
        self.assertEqual(flux.PointData["flux_magnitude"].GetNumberOfComponents(), 1)

    def test_lattice_boltzmann_has_times(self):
        tissue = pv.MicrostructureSource(Size=[60, 50, 1])
        heat = pv.LatticeBoltzmann(Input=tissue, EndTime=1e-3, NumberOfSteps=4)
        heat.UpdatePipelineInformation()
        self.assertEqual(list(heat.TimestepValues), [0, 0.00025, 0.0005, 0.00075, 0.001])
        diffusivity = {"wall": 1.8e-7, "lumen": 2.2e-5}
        expected = lamella.transient(lamella.softwood(size=(60, 50)), diffusivity, 1e-3, 4)
        for k, time in enumerate(heat.TimestepValues):
            heat.UpdatePipeline(time)
            self.assertAlmostEqual(field(heat, "mean_value")[0], expected.mean[k], places=12)

    def test_properties_reach_the_classes(self):
        layers = pv.MicrostructureSource(Kind="Layers", Size=[40, 20, 1], SolidFraction=0.5, Axis="x")
        vapour = pv.SteadyDiffusion(
            Input=layers,
            Conductivities=["matrix", "1", "inclusion", "10"],
            Direction="All",
            Quantity="Concentration",
            Tolerance=1e-10,
            ComputeFlux=0,
        )
        vapour.UpdatePipeline()
        k = field(vapour, "effective_conductivity")
        self.assertAlmostEqual(k[0], 2 / 1.1, places=8)
        self.assertAlmostEqual(k[4], 5.5, places=8)
        self.assertEqual(sorted(vapour.PointData.keys()), ["concentration_x", "concentration_y", "phase"])
        flux = pv.FluxMap(Input=vapour, Direction="y", NumberOfStreamlines=7)
        flux.UpdatePipeline()
        self.assertEqual(servermanager.Fetch(flux, idx=1).GetNumberOfLines(), 7)

    def test_pores(self):
        tissue = pv.MicrostructureSource(Size=[90, 80, 1])
        pores = pv.PoreFloodFill(Input=tissue)  # the phase is called lumen
        pores.UpdatePipeline()
        expected = lamella.pore_flood_fill(lamella.softwood(size=(90, 80)))
        self.assertEqual(field(pores, "pore_count")[0], expected.count)
        self.assertEqual(servermanager.Fetch(pores, idx=1).GetNumberOfRows(), expected.count)
        self.assertGreater(servermanager.Fetch(pores, idx=2).GetNumberOfRows(), 2)
        self.assertEqual(pores.PointData["pore"].GetRange(), (0, expected.count))
        walls = pv.PoreFloodFill(Input=tissue, Phase="wall", Connectivity="8 (picture: and corners)",
                                 Periodic=[1, 1, 0], MinimumSize=5, SortBySize=0, ComputePoreSize=0)
        walls.UpdatePipeline()
        expected = lamella.pore_flood_fill(lamella.softwood(size=(90, 80)), "wall", 8, "xy", 5, False)
        self.assertEqual(field(walls, "pore_largest")[0], expected.largest)
        self.assertEqual(field(walls, "pore_dropped"), list(expected.dropped))
        self.assertEqual(sorted(walls.PointData.keys()), ["phase", "pore"])

    def test_fit(self):
        """Samples as inputs, a solver that is chosen in the panel, tables of what was found; what runs again."""
        tissue = pv.MicrostructureSource(Size=[90, 80, 1], Seed=3)
        fit = pv.MaterialFit(Input=[tissue], Unknowns=["wall"], Measurements=["y=0.112±0.003"])
        self.assertEqual(list(fit.GetProperty("Solver").Available), ["Steady Diffusion", "Voxel Stiffness"])
        fit.Solver.Conductivities = ["lumen", "0.026"]
        fit.UpdatePipeline()
        sample = lamella.softwood(size=(90, 80), seed=3)
        told = lamella.fit("diffusion", sample, "wall", {"y": (0.112, 0.003)}, conductivity={"lumen": 0.026})
        found = servermanager.Fetch(fit, idx=1)
        self.assertEqual(found.GetValueByName(0, "unknown").ToString(), "conductivity:wall")
        for column, expected in (("value", told.values), ("low", told.low), ("high_by_measurement", told.high_by_measurement)):
            self.assertAlmostEqual(found.GetValueByName(0, column).ToDouble(), expected["conductivity:wall"], places=9)
        measured = servermanager.Fetch(fit, idx=2)
        self.assertAlmostEqual(measured.GetValueByName(0, "lattice_and_picture").ToDouble(), told.lattice_and_picture["y"], places=9)
        self.assertEqual(sorted(fit.PointData.keys()), ["flux_x", "flux_y", "phase", "temperature_x", "temperature_y"])
        # another number of the solver's runs it again, and all outputs show it; nothing does not
        runs = []
        fit.GetClientSideObject().AddObserver("StartEvent", lambda *_: runs.append(1))
        fit.UpdatePipeline()
        self.assertEqual(len(runs), 0)
        fit.Solver.Conductivities = ["lumen", "0.05"]
        fit.UpdatePipeline()
        self.assertEqual(len(runs), 1)
        told = lamella.fit("diffusion", sample, "wall", {"y": (0.112, 0.003)}, conductivity={"lumen": 0.05})
        self.assertAlmostEqual(servermanager.Fetch(fit, idx=1).GetValueByName(0, "value").ToDouble(), told.values["conductivity:wall"], places=9)
        # another solver, a second sample at another moisture
        dense = pv.MicrostructureSource(Size=[90, 80, 1], Seed=4, SolidFraction=0.5)
        fit.Solver = "Voxel Stiffness"
        fit.Solver.PoissonsRatios = ["wall", "0.2"]
        fit.Input = [tissue, dense]
        fit.Unknowns = ["young:wall", "slope:young:wall"]
        fit.Measurements = ["E_x@0=1e9+-2e7", "2/E_x@0.12=1e9+-2e7"]
        fit.UpdatePipeline()
        told = lamella.fit("stiffness", sample, ["young:wall", "slope:young:wall"], {"E_x@0": (1e9, 2e7), "2/E_x@0.12": (1e9, 2e7)},
                           also=[lamella.softwood(size=(90, 80), seed=4, solid_fraction=0.5)], poisson={"wall": 0.2})
        found = servermanager.Fetch(fit, idx=1)
        for row, name in enumerate(("young:wall", "slope:young:wall")):
            self.assertEqual(found.GetValueByName(row, "unknown").ToString(), name)
            self.assertAlmostEqual(found.GetValueByName(row, "value").ToDouble() / told.values[name], 1, places=9)
        state = smstate.get_state()  # a script, with the solver that was chosen and what is known
        for line in (".Solver = 'Voxel Stiffness'", ".Solver.PoissonsRatios = ['wall', '0.2']"):
            self.assertIn(line, state)

    def test_stresses(self):
        tissue = pv.MicrostructureSource(Size=[90, 80, 1])
        stresses = pv.Calculator(Input=tissue, ResultArrayName="yy", Function="coordsX*coordsX - 1e-10")
        pdf = pv.StressPDF(Input=stresses, StressArray=["POINTS", "yy"], Threshold=1.5, BinWidth=0.25,
                           Phases=["wall"], ReferenceStress=1e-10)
        pdf.UpdatePipeline()
        density = servermanager.Fetch(pdf, idx=0)
        phases = servermanager.Fetch(pdf, idx=1)
        self.assertEqual(phases.GetNumberOfRows(), 2)
        self.assertEqual(phases.GetColumnByName("phase").GetValue(1), "wall")
        wall = lamella.softwood(size=(90, 80)).phase == 1
        x = (np.arange(90) + 0.5) * tissue.Spacing
        value = np.broadcast_to(x * x - 1e-10, (80, 90))[wall]
        self.assertEqual(phases.GetColumnByName("count").GetValue(0), wall.sum())
        self.assertAlmostEqual(phases.GetColumnByName("mean_tensile").GetValue(0) / value[value > 0].mean(), 1)
        count = density.GetColumnByName("count")
        self.assertEqual(sum(count.GetValue(i) for i in range(density.GetNumberOfRows())), wall.sum())
        self.assertIsNotNone(density.GetColumnByName("density_wall"))
        self.assertGreater(servermanager.Fetch(pdf, idx=2).GetNumberOfRows(), 3)

    def test_compression_curve(self):
        source = pv.ProgrammableSource(OutputDataSetType="vtkTable", Script="""
from vtkmodules.vtkCommonCore import vtkDoubleArray
for name in ("strain", "force"):
    column = vtkDoubleArray()
    column.SetName(name)
    for i in range(801):
        e = i * 1e-3
        column.InsertNextValue(e if name == "strain" else 2e8 * e if e < 0.02 else 4e6 if e < 0.5 else 4e6 + 4e8 * (e - 0.5) ** 2)
    self.GetTableOutput().AddColumn(column)
""")
        curve = pv.CompressionCurve(Input=source, StressColumn=["ROWS", "force"], StiffnessRange=[0, 0.015], PlateauRange=[0.2, 0.4])
        curve.UpdatePipeline()
        table = servermanager.Fetch(curve)
        self.assertAlmostEqual(table.GetColumnByName("absorbed_energy").GetValue(20), 4e4, places=3)
        numbers = curve.GetClientSideObject().GetOutputDataObject(0).GetFieldData()  # a table that is fetched has none
        self.assertAlmostEqual(numbers.GetArray("curve_stiffness").GetValue(0) / 2e8, 1)
        self.assertAlmostEqual(numbers.GetArray("curve_plateau_stress").GetValue(0) / 4e6, 1)
        self.assertAlmostEqual(numbers.GetArray("curve_densification_strain").GetValue(0), 0.51, delta=0.002)

    def test_collapse_map(self):
        tissue = pv.MicrostructureSource(Kind="Honeycomb", Size=[84, 96, 1])
        # a point a node of the wall; two states, and a source of both as time steps
        phase = lamella.honeycomb(size=(84, 96)).phase[::-1]
        script = """
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
wall = np.array({wall})
strain = {strain}
places = (np.column_stack([wall[:, ::-1], np.zeros(len(wall))]) + 0.5) * {spacing}
places[:, 1] *= 1 - strain
out = self.GetPolyDataOutput()
points = vtkPoints()
points.SetData(numpy_to_vtk(places, deep=True))
out.SetPoints(points)
for name, values in (("id", np.arange(len(wall), dtype=np.uint32)),
                     ("deformation_gradient", np.tile([1.0, 0, 0, 1 - strain], (len(wall), 1)))):
    array = numpy_to_vtk(values, deep=True)
    array.SetName(name)
    out.GetPointData().AddArray(array)
{field}
"""
        told = """
array = numpy_to_vtk(np.array([strain]), deep=True)
array.SetName("strain")
out.GetFieldData().AddArray(array)
"""
        words = {"wall": np.argwhere(phase == 1).tolist(), "spacing": tissue.Spacing}
        states = [pv.ProgrammableSource(OutputDataSetType="vtkPolyData", Script=script.format(strain=s, field=told, **words))
                  for s in (0.3, 0.6)]
        collapse = pv.CollapseMap(Input=tissue, Points=states)
        collapse.UpdatePipeline()
        self.assertAlmostEqual(field(collapse, "first_collapse_strain")[0], 0.5, places=6)
        self.assertEqual(field(collapse, "state_count"), [2])
        count = field(collapse, "lumen_count")[0]
        self.assertEqual(servermanager.Fetch(collapse, idx=1).GetNumberOfRows(), count)
        self.assertEqual(servermanager.Fetch(collapse, idx=2).GetNumberOfRows(), 2)
        information = """
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as pipeline
self.GetOutputInformation(0).Set(pipeline.TIME_STEPS(), [0.2, 0.4, 0.6], 3)
self.GetOutputInformation(0).Set(pipeline.TIME_RANGE(), [0.2, 0.6], 2)
"""
        time = ("__import__('vtkmodules.vtkCommonExecutionModel').vtkCommonExecutionModel.vtkStreamingDemandDrivenPipeline"
                ".UPDATE_TIME_STEP()")
        steps = pv.ProgrammableSource(OutputDataSetType="vtkPolyData", ScriptRequestInformation=information,
                                      Script=script.format(strain=f"self.GetOutputInformation(0).Get({time})", field="", **words))
        collapse.Points = [steps]  # in place of the two
        collapse.Share = 0.7
        collapse.UpdatePipeline()
        self.assertEqual(field(collapse, "state_count"), [3])
        self.assertAlmostEqual(field(collapse, "first_collapse_strain")[0], 0.3, places=6)
        self.assertEqual(field(collapse, "lumen_collapsed"), [count])

    def test_bond_stiffness(self):
        tissue = pv.MicrostructureSource(Kind="Honeycomb", Size=[84, 96, 1])
        cell = pv.BondStiffness(Input=tissue)  # Young's modulus of walls
        cell.UpdatePipeline()
        expected = lamella.bond_stiffness(servermanager.Fetch(tissue), {"wall": 1e10})
        np.testing.assert_allclose(field(cell, "constants"), list(expected.constants.values()), rtol=1e-9)
        tensor = servermanager.Fetch(cell, idx=1)
        self.assertAlmostEqual(tensor.GetColumnByName("xx").GetValue(0) / expected.stiffness[0, 0], 1)
        constants = servermanager.Fetch(cell, idx=2)
        self.assertEqual(constants.GetColumnByName("constant").GetValue(0), "E_x")
        own = pv.BondStiffness(Input=tissue, YoungsModuli=["wall", "2e10"], EstimateError=0, Micromodulus="Lattice: exact along the axes")
        own.UpdatePipeline()
        lattice = lamella.bond_stiffness(servermanager.Fetch(tissue), {"wall": 2e10}, micromodulus="lattice", estimate_error=False)
        self.assertAlmostEqual(field(own, "stiffness")[0] / lattice.stiffness[0, 0], 1, places=9)
        self.assertNotAlmostEqual(lattice.stiffness[0, 0] / expected.stiffness[0, 0] / 2, 1, places=2)

    def test_fracture(self):
        tissue = pv.MicrostructureSource(Kind="Honeycomb", Size=[42, 48, 1], SolidFraction=0.6)
        torn = pv.BondFracture(Input=tissue)  # Young's modulus and critical stretch of walls
        torn.UpdatePipeline()
        expected = lamella.fracture(servermanager.Fetch(tissue), {"wall": 1e10}, critical_stretch={"wall": 0.01})
        self.assertEqual(field(torn, "peak_stress")[0], expected.peak_stress)
        torn.SMProxy.UpdatePropertyInformation()
        self.assertEqual(torn.GetPropertyValue("PeakStress"), expected.peak_stress)
        self.assertEqual(servermanager.Fetch(torn, idx=1).GetNumberOfPoints(), len(expected.broken))
        self.assertEqual(servermanager.Fetch(torn, idx=2).GetNumberOfRows(), len(expected.strain))
        self.assertEqual(sorted(torn.PointData.keys()), ["broken", "damage", "displacement", "phase"])
        torn.StatesAtBroken = [3, 6]
        torn.ComputeDisplacement = 0
        for state, broken in ((0, 3), (1, 6), (-1, len(expected.broken))):
            torn.State = state
            torn.UpdatePipeline()
            self.assertEqual(field(torn, "broken_bonds")[0], broken)
        self.assertEqual(sorted(torn.PointData.keys()), ["broken", "damage", "phase"])

    def test_curves_open_as_line_charts(self):
        """Tables are spreadsheets in ParaView, and of a chart all columns over the number of the row; curves are neither."""
        tissue = pv.MicrostructureSource(Kind="Honeycomb", Size=[42, 48, 1], SolidFraction=0.6)
        torn = pv.BondFracture(Input=tissue)
        moved = pv.BondDynamics(Input=tissue, EndTime=2e-9, Pull=0, SideTractions=["x-", "x", "1e5"])
        pressed = pv.PointCompression(Input=tissue, Strain=0.02, Rows=20, FirstSpeed=0.01)
        curve = pv.CompressionCurve(Input=servermanager.OutputPort(pressed, 1))
        stretched = pv.BondEquilibrium(Input=tissue, ComputeStress=1)
        density = pv.StressPDF(Input=stretched)
        stiff = pv.BondStiffness(Input=tissue, EstimateError=0)
        controller = servermanager.vtkSMParaViewPipelineControllerWithRendering()
        for source, port, x, y in ((torn, 2, "strain", ["stress"]), (moved, 2, "time", ["stress"]), (pressed, 1, "strain", ["stress"]),
                                   (curve, 0, "strain", ["stress"]), (density, 0, "stress", ["density", "tail"])):
            with self.subTest(source.SMProxy.GetXMLName()):
                source.UpdatePipeline()
                self.assertEqual(controller.GetPreferredViewType(source.SMProxy, port), "XYChartView")
                if port > 0:
                    self.assertNotEqual(controller.GetPreferredViewType(source.SMProxy, 0), "XYChartView")
                shown = pv.Show(servermanager.OutputPort(source, port), pv.CreateView("XYChartView"))
                self.assertEqual((shown.UseIndexForXAxis, shown.XArrayName), (0, x))
                series = shown.SMProxy.GetProperty("SeriesVisibility")
                drawn = {series.GetElement(i): series.GetElement(i + 1) for i in range(0, series.GetNumberOfElements(), 2)}
                self.assertEqual(sorted(name for name, on in drawn.items() if on == "1"), y)
                columns = servermanager.Fetch(source, idx=port).GetRowData()
                names = [columns.GetArrayName(i) for i in range(columns.GetNumberOfArrays())]
                own = [name for name in names if not name.endswith("_wall")]  # of phases, as they are called
                if source is curve:  # which hands on what columns its input has
                    own = [name for name in own if name in drawn]
                self.assertEqual(sorted(drawn), sorted(own), "every column can be chosen")
        stiff.UpdatePipeline()
        self.assertEqual(controller.GetPreferredViewType(stiff.SMProxy, 1), "SpreadSheetView")

    def test_a_value_stands_in_the_view(self):
        heat = pv.SteadyDiffusion(Input=pv.MicrostructureSource(Size=[40, 30, 1]))
        heat.UpdatePipeline()
        text = pv.AnnotateAttributeData(Input=heat, SelectInputArray=["FIELD", "effective_conductivity"], Prefix="effective: ")
        text.UpdatePipeline()
        said = servermanager.Fetch(text).GetColumn(0).GetValue(0)
        self.assertTrue(said.startswith("effective: "), said)
        self.assertAlmostEqual(float(said.split()[1]), field(heat, "effective_conductivity")[0], places=12)

    def test_fracture_goes_on(self):
        tissue = pv.MicrostructureSource(Kind="Honeycomb", Size=[42, 48, 1], SolidFraction=0.6)
        whole = pv.BondFracture(Input=tissue, CheckpointEvery=4)
        whole.UpdatePipeline()
        count = servermanager.Fetch(whole, idx=1).GetNumberOfPoints()
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "run.h5")
            first = pv.BondFracture(Input=tissue, CheckpointFile=file, CheckpointEvery=4, MaximumBroken=10)
            first.UpdatePipeline()
            self.assertEqual(field(first, "last_checkpoint"), [8])
            second = pv.BondFracture(Input=tissue, ContinueFile=file, CheckpointEvery=4)
            second.UpdatePipeline()
            self.assertEqual(field(second, "continued_at"), [8])
        self.assertEqual(servermanager.Fetch(second, idx=1).GetNumberOfPoints(), count)
        self.assertEqual(field(second, "peak_stress"), field(whole, "peak_stress"))

    def test_compression(self):
        tissue = pv.MicrostructureSource(Kind="Honeycomb", Size=[42, 48, 1], SolidFraction=0.6)
        still = pv.PointStiffness(Input=tissue)
        still.UpdatePipeline()
        image = servermanager.Fetch(tissue)
        expected = lamella.point_stiffness(image)
        self.assertEqual(field(still, "constants"), list(expected.constants.values()))
        self.assertEqual(servermanager.Fetch(still).GetColumnByName("constant").GetValue(0), "E_x")
        self.assertEqual(servermanager.Fetch(still, idx=1).GetNumberOfRows(), 2)
        own = pv.PointStiffness(Input=tissue, PhaseConstants=["wall", "young", "1.44e10"], Sides="Periodic: the whole tensor")
        own.UpdatePipeline()
        expected = lamella.point_stiffness(image, young=14.4e9, sides="periodic")
        np.testing.assert_allclose(field(own, "stiffness"), expected.stiffness.ravel(), rtol=1e-12)
        pressed = pv.PointCompression(Input=tissue, Strain=0.03, Rows=6, FirstSpeed=0.01, StatesAtStrains=[0.01], ComputeStress=1)
        pressed.UpdatePipeline()
        expected = lamella.compression(image, strain=0.03, rows=6, first_speed=0.01)
        self.assertEqual(field(pressed, "stress"), [expected.stress[-1]])
        self.assertEqual(sorted(pressed.PointData.keys()), ["displacement", "id", "phase", "stress"])
        curve = servermanager.Fetch(pressed, idx=1)
        self.assertEqual([curve.GetColumnByName("stress").GetValue(i) for i in range(7)], list(expected.stress))
        pressed.State = 0  # runs nothing again
        pressed.UpdatePipeline()
        self.assertAlmostEqual(field(pressed, "strain")[0], 0.01, places=9)

    def test_motion(self):
        tissue = pv.MicrostructureSource(Kind="Honeycomb", Size=[42, 48, 1], SolidFraction=0.6)
        torn = pv.BondDynamics(Input=tissue)  # Young's modulus and critical stretch of walls
        torn.UpdatePipeline()
        image = servermanager.Fetch(tissue)
        expected = lamella.dynamics(image, {"wall": 1e10}, 1000, critical_stretch={"wall": 0.01})
        self.assertEqual(field(torn, "peak_stress")[0], expected.peak_stress)
        self.assertEqual(servermanager.Fetch(torn, idx=1).GetNumberOfPoints(), len(expected.broken))
        self.assertEqual(servermanager.Fetch(torn, idx=2).GetNumberOfRows(), len(expected.time))
        self.assertEqual(sorted(torn.PointData.keys()), ["broken", "damage", "displacement", "phase", "velocity"])
        struck = pv.BondDynamics(
            Input=tissue, Pull=0, PhaseDensities=["wall", "1500"], SideVelocities=["y+", "y", "30", "y+", "x", "0"],
            SideTractions=["x-", "x", "1e5"], BoxVelocities=["0", "0", "0", "1", "2e-6", "0", "y", "-30"], EndTime=2e-9,
            StatesAtTimes=[1e-9], StepShare=0.5)
        struck.UpdatePipeline()
        expected = lamella.dynamics(
            image, {"wall": 1e10}, {"wall": 1500}, critical_stretch={"wall": 0.01}, velocities={"y+": (0, 30)},
            tractions={"x-": (1e5, 0)}, boxes=[((0, 0), (1, 2e-6), (None, -30))], end_time=2e-9, at_times=[1e-9],
            step_share=0.5)
        self.assertEqual(field(struck, "supplied_energy")[0], expected.energies["supplied"][-1])
        self.assertGreater(field(struck, "supplied_energy")[0], 0)
        for state in (0, 1):
            struck.State = state
            struck.UpdatePipeline()
            self.assertEqual(field(struck, "time")[0], expected.states[state].time)

    def test_cracks(self):
        tissue = pv.MicrostructureSource(Kind="Honeycomb", Size=[42, 48, 1], SolidFraction=0.6)
        torn = pv.BondFracture(Input=tissue)
        for image in (None, torn):
            cracks = pv.CrackPath(Input=pv.OutputPort(torn, 1), Image=image)
            cracks.UpdatePipeline()
            result = lamella.fracture(servermanager.Fetch(tissue), {"wall": 1e10}, critical_stretch={"wall": 0.01})
            expected = lamella.crack_path(result if image else result.vtk_broken)
            self.assertEqual(field(cracks, "crack_length")[0], expected.length)
            self.assertEqual((field(cracks, "main_tip")[0], field(cracks, "main_tip")[1]), expected.tip)
            self.assertEqual(servermanager.Fetch(cracks).GetNumberOfCells(), len(expected.lines))
            self.assertEqual(servermanager.Fetch(cracks, idx=1).GetNumberOfRows(), len(expected.lines))
            if image:
                self.assertEqual(servermanager.Fetch(cracks, idx=5).GetNumberOfRows(), len(expected.fragments["nodes"]))
                self.assertEqual(servermanager.Fetch(cracks, idx=4).GetDimensions(), (42, 48, 1))

    def test_grains(self):
        grains = pv.GrainPacking(Count=60, Softness=1e-4, Seed=4)
        cemented = pv.MatrixBridges(Input=grains, Saturation=0.4, NodesAcross=50)
        heat = pv.SteadyDiffusion(Input=cemented, Conductivities=["void", "0.01", "matrix", "0.1", "grain", "1"])
        heat.UpdatePipeline()
        packing = lamella.packing(count=60, softness=1e-4, seed=4)
        sample = lamella.bridges(packing, saturation=0.4, nodes_across=50)
        self.assertAlmostEqual(field(cemented, "saturation")[0], 0.4, places=5)
        self.assertEqual(field(cemented, "width")[0], sample.width)
        expected = lamella.diffusion(sample, {"void": 0.01, "matrix": 0.1, "grain": 1}, "x")
        self.assertAlmostEqual(field(heat, "effective_conductivity")[0], expected.effective[0, 0], places=7)
        self.assertEqual(servermanager.Fetch(grains, idx=1).GetNumberOfLines(), len(packing.forces))
        # As people draw them.
        glyphs = pv.Glyph(Input=grains, GlyphType="Sphere", ScaleArray=["POINTS", "diameter"], ScaleFactor=1,
                          GlyphMode="All Points")
        glyphs.UpdatePipeline()
        self.assertGreater(servermanager.Fetch(glyphs).GetNumberOfPoints(), 60 * 20)
        with open("grains.csv", "w", encoding="utf-8") as file:
            file.write("x,z,r\n1,1,1\n3,1,1\n")
        table = pv.PackingReader(FileName="grains.csv", LengthUnit=1e-3)
        self.assertEqual(field(table, "box"), [0.004, 0.002, 0])

    def test_micrographs(self):
        tissue = pv.MicrostructureSource(Size=[180, 150, 1], Spacing=5e-7)
        outlines = pv.MicrographContours(Input=tissue, SmallestArea=1e-11)
        lattice = pv.MicrographLattice(Input=outlines, Spacing=4e-7, Lamella="Constant thickness",
                                       LamellaThickness=8e-7)
        heat = pv.SteadyDiffusion(
            Input=lattice, Conductivities=["void", "0.02", "secondary wall", "1", "middle lamella", "0.5"])
        heat.UpdatePipeline()
        expected = lamella.contours(lamella.softwood(size=(180, 150), spacing=5e-7), smallest_area=1e-11)
        sample = expected.lattice(4e-7, "constant", lamella_thickness=8e-7)
        self.assertEqual(servermanager.Fetch(outlines).GetNumberOfLines(), len(expected))
        self.assertEqual(field(outlines, "wall_fraction")[0], expected.wall_fraction)
        self.assertEqual(field(lattice, "lamella_share")[0], sample.lamella_share)
        self.assertEqual(sorted(lattice.PointData.keys()), ["axis", "grain", "lumen_share", "phase"])
        self.assertEqual(lattice.PointData["axis"].GetNumberOfComponents(), 3)
        result = lamella.diffusion(sample, {"void": 0.02, "secondary wall": 1, "middle lamella": 0.5}, "x")
        self.assertAlmostEqual(field(heat, "effective_conductivity")[0], result.effective[0, 0], places=7)
        directed = pv.SteadyDiffusion(
            Input=lattice, Conductivities=["void", "0.02", "secondary wall", "1.2", "middle lamella", "0.5"],
            ConductivitiesAcross=["secondary wall", "0.8"])
        directed.UpdatePipeline()
        result = lamella.diffusion(sample, {"void": 0.02, "secondary wall": (1.2, 0.8), "middle lamella": 0.5}, "x")
        self.assertAlmostEqual(field(directed, "effective_conductivity")[0], result.effective[0, 0], places=7)
        self.assertNotAlmostEqual(result.effective[0, 0], field(heat, "effective_conductivity")[0], places=3)
        through = pv.OutlineDiffusion(Input=outlines, Picture=tissue, Conductivities=["lumen", "0.02", "wall", "1"], Direction="x")
        through.UpdatePipeline()
        result = lamella.outline_diffusion(expected, {"lumen": 0.02, "wall": 1}, "x")
        self.assertEqual(field(through, "effective_conductivity")[0], result.conductivity["x"])
        self.assertEqual(field(through, "picture_error")[0], result.picture_error["x"])
        alone = pv.OutlineDiffusion(Input=outlines)  # conductivities of heat, without the picture
        alone.UpdatePipeline()
        self.assertEqual(field(alone, "picture_error"), [0])
        walls = pv.MicrographContours(Input=tissue, LumenPhase="lumen", Smooth=0, LeastSolidity=0.5)
        walls.UpdatePipeline()
        raw = lamella.contours(lamella.softwood(size=(180, 150), spacing=5e-7), smooth=False, least_solidity=0.5)
        self.assertEqual(servermanager.Fetch(walls).GetNumberOfPoints(), sum(map(len, raw.chains)))
        with open("polygons.json", "w", encoding="utf-8") as file:
            file.write('{"units": "mm", "cells": [{"lumen": [[1, 1], [4, 1], [4, 4], [1, 4]], '
                       '"outer": [[0, 0], [5, 0], [5, 5], [0, 5]]}]}')
        polygons = pv.MicrographPolygonReader(FileName="polygons.json", Unit=1e-6, YDown=1)
        self.assertAlmostEqual(field(polygons, "size")[0] * 1e6, 5)
        self.assertEqual(servermanager.Fetch(polygons, idx=1).GetNumberOfLines(), 1)

    def test_bonds(self):
        grains = pv.GrainPacking(Count=60, Softness=1e-4, Seed=4)
        cemented = pv.MatrixBridges(Input=grains, Saturation=0.4, NodesAcross=50)
        loaded = pv.BondEquilibrium(Input=cemented)  # Young's moduli of grains and matrix
        loaded.UpdatePipeline()
        sample = lamella.bridges(lamella.packing(count=60, softness=1e-4, seed=4), saturation=0.4, nodes_across=50)
        expected = lamella.equilibrium(sample, {"matrix": 1e9, "grain": 4e9, "matrix-grain": 1e9})
        modulus = expected.effective_modulus
        self.assertAlmostEqual(field(loaded, "effective_modulus")[0] / modulus, 1, places=9)
        loaded.SMProxy.UpdatePropertyInformation()
        self.assertAlmostEqual(loaded.GetPropertyValue("EffectiveModulus") / modulus, 1, places=9)
        self.assertEqual(sorted(loaded.PointData.keys()), ["displacement", "grain", "phase"])
        stress = pv.BondStress(Input=loaded)
        stress.UpdatePipeline()
        self.assertEqual(stress.PointData["stress"].GetNumberOfComponents(), 6)
        own = pv.BondEquilibrium(
            Input=cemented,
            YoungsModuli=["matrix", "1e9", "grain", "4"],
            CriticalStretches=["matrix", "1e-3", "grain", "1", "grain-grain", "0.5"],
            Likes=["matrix-grain", "matrix", "grain-grain", "matrix"],
            RelativeTo="matrix",
            Load="Shear",
            LoadAxis="x",
            Strain=1e-4,
            ComputeStress=1,
            Notches=[0, 0.002, 0.001, 0.002],
        )
        own.UpdatePipeline()
        expected = lamella.equilibrium(
            sample, {"matrix": 1e9, "grain": 4e9}, critical_stretch={"matrix": 1e-3, "grain": 1e-3, "grain-grain": 5e-4},
            like={"matrix-grain": "matrix", "grain-grain": "matrix"}, load="shear", axis="x", strain=1e-4,
            notches=[((0, 0.002), (0.001, 0.002))])
        for name in ("effective_modulus", "first_break_strain"):
            self.assertAlmostEqual(field(own, name)[0] / getattr(expected, name), 1, places=9)
        self.assertEqual(own.PointData["stress"].GetNumberOfComponents(), 6)

    def test_reader(self):
        path = lamella.softwood(size=(30, 20)).save("reader.vti", overwrite=True)
        picture = pv.PictureReader(FileName=path, Phases=["0", "void", "1", "solid"], Window=[0, 0, 0, 20, 10, 0])
        picture.UpdatePipeline()
        self.assertEqual(servermanager.Fetch(picture).GetDimensions(), (20, 10, 1))
        names = servermanager.Fetch(picture).GetFieldData().GetAbstractArray("phase_names")
        self.assertEqual([names.GetValue(i) for i in range(2)], ["void", "solid"])

    def test_saving_vtkhdf(self):
        sample = pv.MicrostructureSource(Kind="Layers", Size=[30, 20, 10], SolidFraction=0.5, Axis="x")
        pv.SaveData("sample.hdf", proxy=sample)
        back = pv.OpenDataFile("sample.hdf")
        back.UpdatePipeline()
        self.assertEqual(type(back).__name__, "VTKHDFReader")
        for one in (back, sample):
            self.assertEqual(servermanager.Fetch(one).GetDimensions(), (30, 20, 10))
        self.assertEqual(back.PointData["phase"].GetRange(), sample.PointData["phase"].GetRange())


if __name__ == "__main__":
    unittest.main(argv=["proxies"], verbosity=2)
