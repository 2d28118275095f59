"""A number out of its range is refused in the same words in the shell and in Python, and kept by the class, as ParaView sets it."""

import os
import subprocess
import tempfile
import unittest

import lamella

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
        bonds = {"young": {"wall": 1e10}, "critical_stretch": {"wall": 0.01}}
        bond_words = ["--young", "wall=1e10", "--critical-stretch", "wall=0.01"]
        heat, warm = {"conductivity": {"lumen": 0.02, "wall": 1}}, ["--conductivity", "lumen=0.02", "--conductivity", "wall=1"]
        sample = lamella.softwood(size=(40, 30), seed=2)
        table = (  # command, what it needs, the same in Python, function, option, value, value in Python
            ("diffusion", warm, heat, lamella.diffusion, "tolerance", "0.5", 0.5),
            ("diffusion", warm, heat, lamella.diffusion, "max-iterations", "0", 0),
            ("diffusion", warm, heat, lamella.diffusion, "sides", "insulted", "insulted"),
            ("diffusion", warm[:2], {"conductivity": {"lumen": 0.02}}, lamella.diffusion, "direction", "x", "x"),
            ("diffusion", [*warm, "--no-error-estimate"], {**heat, "estimate_error": False}, lamella.diffusion, "target-error", "0.01", 0.01),
            ("transient", ["--diffusivity", "wall=1e-7", "--diffusivity", "lumen=1e-5"], {"diffusivity": {"wall": 1e-7, "lumen": 1e-5}, "end_time": 1e-6},
             lamella.transient, "frames", "0", 0),
            ("equilibrium", bond_words[:2], {"young": {"wall": 1e10}}, lamella.equilibrium, "horizon", "0.5", 0.5),
            ("equilibrium", bond_words[:2], {"young": {"wall": 1e10}}, lamella.equilibrium, "traction", "1e6", 1e6),
            ("fracture", bond_words, bonds, lamella.fracture, "lateral-ratio", "0.5", 0.5),
            ("fracture", bond_words, bonds, lamella.fracture, "stop", "1", 1),
            ("dynamics", bond_words, bonds, lamella.dynamics, "damping", "2", 2),
            ("stiffness", bond_words[:2], {"young": {"wall": 1e10}}, lamella.stiffness, "tolerance", "0", 0),
            ("compression", [], {}, lamella.compression, "strain", "1", 1),
            ("compression", [], {}, lamella.compression, "transfer", "flop", "flop"),
            ("pore-flood-fill", [], {}, lamella.pore_flood_fill, "minimum-size", "-2", -2),
        )
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
                    for word, text in zip([*words, *end][::2], [*words, *end][1::2]) if "--no-error-estimate" not in words else zip(warm[::2], warm[1::2]):
                        options.setdefault(word[2:], []).append(text)
                    lines = ["[sample]", 'file = "t.vti"', f"[{command}]", f'{option} = "{value}"']
                    lines += [f"{key} = {texts if '=' in texts[0] else texts[0]!r}".replace("'", '"') for key, texts in options.items()]
                    lines += ["no-error-estimate = true"] if "--no-error-estimate" in words else []
                    with open(os.path.join(folder, "s.toml"), "w", encoding="utf-8") as file:
                        file.write("\n".join([*lines, ""]))
                    dry = subprocess.run([PROGRAM, "run", "s.toml", "--dry-run"], cwd=folder, capture_output=True, text=True, check=False)
                    self.assertIn(said, dry.stderr + dry.stdout)

    def test_words_that_are_none(self):
        with tempfile.TemporaryDirectory() as folder:
            code, said, hint = in_shell(folder, "stress-pdf", "a.vti", "--component", "von-mizes")
            self.assertEqual((code, said, hint), (2, "component 'von-mizes' is none of its choices", "did you mean 'von-mises'?"))


if __name__ == "__main__":
    unittest.main()
