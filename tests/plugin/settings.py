"""What is refused is refused in the same words in the shell, in scenes, in Python, and by the plugin in ParaView."""

import os
import re
import subprocess
import tempfile
import unittest

import lamella

try:
    import paraview.simple as pv
    from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkStringOutputWindow
except ImportError:
    pv = None

PROGRAM = os.environ["LAMELLA_PROGRAM"]
# command, option, value, what Python calls, its keyword, the class, its setter
TABLE = (
    ("stress-pdf", "bin-width", "0", "bin_width", "vtkStressPDF", "SetBinWidth"),
    ("stress-pdf", "tail-share", "1.5", "tail_share", "vtkStressPDF", "SetTailShare"),
    ("stress-pdf", "threshold", "-1", "threshold", "vtkStressPDF", "SetThreshold"),
    ("stress-pdf", "reference", "-2", "reference", "vtkStressPDF", "SetReferenceStress"),
    ("flux-map", "streamlines", "-1", "streamlines", "vtkFluxMap", "SetNumberOfStreamlines"),
    ("flux-map", "streamlines", "2000000", "streamlines", "vtkFluxMap", "SetNumberOfStreamlines"),
    ("crack-path", "horizon", "9", "horizon", "vtkCrackPath", "SetHorizon"),
    ("crack-path", "minimum-length", "nan", "minimum_length", "vtkCrackPath", "SetMinimumLength"),
    ("compression-curve", "offset", "1", "offset", "vtkCompressionCurve", "SetOffset"),
    ("compression-curve", "prominence", "-0.5", "prominence", "vtkCompressionCurve", "SetProminence"),
    ("collapse-map", "share", "1", "share", "vtkCollapseMap", "SetShare"),
    ("collapse-map", "minimum-size", "-4", "minimum_size", "vtkCollapseMap", "SetMinimumSize"),
)


def solved():
    """An image with all that the filters look for."""
    return lamella.diffusion(lamella.laminate((8, 6)), {"matrix": 1, "inclusion": 2})


def in_python(command, keyword, value):
    image = solved()
    call = {
        "stress-pdf": lambda **how: lamella.stress_pdf(image, **how),
        "flux-map": lambda **how: lamella.flux_map(image, **how),
        "crack-path": lambda **how: lamella.crack_path(lamella.vtkCrackPath().GetOutput(), **how),
        "compression-curve": lambda **how: lamella.compression_curve([0, 0.1, 0.2], [0, 1, 2], **how),
        "collapse-map": lambda **how: lamella.collapse_map(image, lamella.vtkCrackPath().GetOutput(), **how),
    }[command]
    try:
        call(**{keyword: float(value) if "." in value or value == "nan" else int(value)})
    except lamella.LamellaError as error:
        return error.message, error.hint
    return "", ""


WARM = ["--conductivity", "lumen=0.02", "--conductivity", "wall=1"]


def tissue():
    return lamella.softwood(size=(40, 30), seed=2)


def doors():
    """Mistakes of those who solve."""
    bonds = {"young": {"wall": 1e10}, "critical_stretch": {"wall": 0.01}}
    bond_words = ["--young", "wall=1e10", "--critical-stretch", "wall=0.01"]
    heat = {"conductivity": {"lumen": 0.02, "wall": 1}}
    return (  # command, what it needs, the same in Python, function, option, value, value in Python
        ("diffusion", WARM, heat, lamella.diffusion, "tolerance", "0.5", 0.5),
        ("diffusion", WARM, heat, lamella.diffusion, "max-iterations", "0", 0),
        ("diffusion", WARM, heat, lamella.diffusion, "sides", "insulted", "insulted"),
        ("diffusion", WARM[:2], {"conductivity": {"lumen": 0.02}}, lamella.diffusion, "direction", "x", "x"),
        ("diffusion", [*WARM, "--no-error-estimate"], {**heat, "estimate_error": False}, lamella.diffusion, "target-error", "0.01", 0.01),
        ("transient", ["--diffusivity", "wall=1e-7", "--diffusivity", "lumen=1e-5"], {"diffusivity": {"wall": 1e-7, "lumen": 1e-5}, "end_time": 1e-6},
         lamella.transient, "frames", "0", 0),
        ("equilibrium", bond_words[:2], {"young": {"wall": 1e10}}, lamella.equilibrium, "horizon", "0.5", 0.5),
        ("equilibrium", bond_words[:2], {"young": {"wall": 1e10}}, lamella.equilibrium, "traction", "1e6", 1e6),
        ("fracture", bond_words, bonds, lamella.fracture, "lateral-ratio", "0.5", 0.5),
        ("fracture", bond_words, bonds, lamella.fracture, "stop", "1", 1),
        ("dynamics", bond_words, bonds, lamella.dynamics, "damping", "2", 2),
        ("stiffness", bond_words[:2], {"young": {"wall": 1e10}}, lamella.stiffness, "max-iterations", "0", 0),
        ("stiffness", bond_words[:2], {"young": {"wall": 1e10}}, lamella.stiffness, "sides", "held", "held"),
        ("bond-stiffness", bond_words[:2], {"young": {"wall": 1e10}}, lamella.bond_stiffness, "tolerance", "0", 0),
        ("compression", [], {}, lamella.compression, "strain", "1", 1),
        ("compression", [], {}, lamella.compression, "transfer", "flop", "flop"),
        ("pore-flood-fill", [], {}, lamella.pore_flood_fill, "minimum-size", "-2", -2),
    )


# the same mistakes in ParaView: the proxy, and its property
PROXIES = {
    ("diffusion", "tolerance"): ("SteadyDiffusion", "Tolerance"),
    ("diffusion", "max-iterations"): ("SteadyDiffusion", "MaximumIterations"),
    ("transient", "frames"): ("LatticeBoltzmann", "NumberOfSteps"),
    ("equilibrium", "horizon"): ("BondEquilibrium", "Horizon"),
    ("fracture", "stop"): ("BondFracture", "StopShare"),
    ("dynamics", "damping"): ("BondDynamics", "Damping"),
    ("stiffness", "max-iterations"): ("VoxelStiffness", "MaximumIterations"),
    ("bond-stiffness", "tolerance"): ("BondStiffness", "Tolerance"),
    ("compression", "strain"): ("PointCompression", "Strain"),
    ("pore-flood-fill", "minimum-size"): ("PoreFloodFill", "MinimumSize"),
}


def in_paraview(proxy, name, value):
    """What the window shows of an update: a proxy of the plugin's XML, a property as a panel sets it."""
    source = pv.MicrostructureSource(Size=[40, 30, 1], Seed=2)
    inputs = {"Input": pv.Sphere() if proxy == "CrackPath" else source}
    if proxy == "CollapseMap":
        inputs["Points"] = pv.Sphere()
    made = getattr(pv, proxy)(**inputs)
    setattr(made, name, value)
    before, window = vtkOutputWindow.GetInstance(), vtkStringOutputWindow()
    vtkOutputWindow.SetInstance(window)
    try:
        made.UpdatePipeline()
    finally:
        vtkOutputWindow.SetInstance(before)
    found = re.search(r"vtk\w+ \(0x[0-9a-f]+\): (.*)\nhint: (.*)\n", window.GetOutput())
    return (found[1], found[2]) if found else ("", window.GetOutput())


def in_shell(folder, *words):
    done = subprocess.run([PROGRAM, *words], cwd=folder, capture_output=True, text=True, check=False)
    lines = done.stderr.splitlines()
    said = next((line for line in lines if line.startswith("error: ")), "error: ")
    hint = next((line for line in lines if line.startswith("hint: ")), "hint: ")
    return done.returncode, said[len("error: "):], hint[len("hint: "):]


class Settings(unittest.TestCase):
    def test_the_same_words(self):
        with tempfile.TemporaryDirectory() as folder:
            for command, option, value, keyword, kind, setter in TABLE:
                with self.subTest(f"{command} --{option}={value}"):
                    files = ["a.vti", "b.vtp"] if command == "collapse-map" else ["a.vti"]
                    code, said, hint = in_shell(folder, command, *files, f"--{option}={value}")
                    self.assertEqual(code, 2)
                    self.assertIn(f"{option.replace('-', ' ')} ", said)
                    self.assertEqual((said, hint), in_python(command, keyword, value))
                    # the setter keeps it, as ParaView's panel sets it: nothing is made to fit
                    algorithm = getattr(lamella, kind)()
                    number = float(value)
                    getattr(algorithm, setter)(int(number) if number == number and number == int(number) and "." not in value else number)
                    kept = getattr(algorithm, "G" + setter[1:])()
                    self.assertTrue(kept == number or number != number and kept != kept)

    def test_through_every_door(self):
        """Out of range, no word, a phase that is missing, what contradicts: shell, scene, Python and the class, as ParaView sets it."""
        sample = tissue()
        table = doors()
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([PROGRAM, "generate", "softwood", "--size", "40,30", "--seed", "2", "-o", "t.vti", "--quiet"], cwd=folder, check=True)
            for command, words, keywords, function, option, value, given in table:
                with self.subTest(f"{command} --{option}={value}"):
                    end = ["--end-time", "1e-6"] if command == "transient" else []
                    code, said, hint = in_shell(folder, command, "t.vti", *words, *end, f"--{option}={value}")
                    self.assertEqual(code, 2)
                    with self.assertRaises(lamella.LamellaError) as caught:
                        function(sample, **{**keywords, option.replace("-", "_"): given})
                    self.assertEqual((caught.exception.message, caught.exception.hint), (said, hint))
                    self.assertIsInstance(caught.exception, lamella.ParameterError)
                    # a scene says the same, and where
                    options = {}
                    for word, text in zip([*words, *end][::2], [*words, *end][1::2]) if "--no-error-estimate" not in words else zip(WARM[::2], WARM[1::2]):
                        options.setdefault(word[2:], []).append(text)
                    lines = ["[sample]", 'file = "t.vti"', f"[{command}]", f'{option} = "{value}"']
                    lines += [f"{key} = {texts if '=' in texts[0] else texts[0]!r}".replace("'", '"') for key, texts in options.items()]
                    lines += ["no-error-estimate = true"] if "--no-error-estimate" in words else []
                    with open(os.path.join(folder, "s.toml"), "w", encoding="utf-8") as file:
                        file.write("\n".join([*lines, ""]))
                    dry = subprocess.run([PROGRAM, "run", "s.toml", "--dry-run"], cwd=folder, capture_output=True, text=True, check=False)
                    self.assertIn(said, dry.stderr + dry.stdout)

    @unittest.skipIf(pv is None, "this Python has no ParaView")
    def test_the_same_words_in_paraview(self):
        try:
            lamella.load_plugin()
        except FileNotFoundError as error:  # built without it
            self.skipTest(str(error))
        sample, held = tissue(), 0
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([PROGRAM, "generate", "softwood", "--size", "40,30", "--seed", "2", "-o", "t.vti", "--quiet"], cwd=folder, check=True)
            for command, option, value, keyword, kind, setter in TABLE:
                if command == "compression-curve":  # takes a table
                    continue
                with self.subTest(f"{kind[3:]} {setter[3:]} = {value}"):
                    files = ["t.vti", "b.vtp"] if command == "collapse-map" else ["t.vti"]
                    _, *shell = in_shell(folder, command, *files, f"--{option}={value}")
                    number = float(value) if "." in value or value == "nan" else int(value)
                    panel = in_paraview(kind[3:], setter[3:], number)
                    self.assertEqual((panel, panel), (tuple(shell), in_python(command, keyword, value)))
                    held += 1
            for command, words, keywords, function, option, value, given in doors():
                if (command, option) not in PROXIES:
                    continue
                proxy, name = PROXIES[command, option]
                with self.subTest(f"{proxy} {name} = {value}"):
                    end = ["--end-time", "1e-6"] if command == "transient" else []
                    _, *shell = in_shell(folder, command, "t.vti", *words, *end, f"--{option}={value}")
                    with self.assertRaises(lamella.ParameterError) as caught:
                        function(sample, **{**keywords, option.replace("-", "_"): given})
                    panel = in_paraview(proxy, name, given)
                    self.assertEqual((panel, panel), (tuple(shell), (caught.exception.message, caught.exception.hint)))
                    held += 1
            # a table of a panel
            _, *shell = in_shell(folder, "diffusion", "t.vti", "--conductivity", "lumen=0.02")
            self.assertEqual(in_paraview("SteadyDiffusion", "Conductivities", ["lumen", "0.02"]), tuple(shell))
        self.assertGreaterEqual(held, 15)

    def test_words_that_are_none(self):
        with tempfile.TemporaryDirectory() as folder:
            code, said, hint = in_shell(folder, "stress-pdf", "a.vti", "--component", "von-mizes")
            self.assertEqual((code, said, hint), (2, "component 'von-mizes' is none of its choices", "did you mean 'von-mises'?"))


if __name__ == "__main__":
    unittest.main()
