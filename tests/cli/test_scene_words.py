"""What a scene gets wrong is told before anything is solved: names of phases, measures, arrays, files, options."""

import glob
import json
import os
import unittest

from program import Case

SAMPLE = """
[sample]
generate = "softwood"
size = [24, 24]
solid-fraction = 0.5
seed = 2
"""

# every command that has a place below a sample
ALL = SAMPLE + """
[diffusion]
conductivity = { lumen = 0.1, wall = 1 }
write = true

[flux-map]
of = "diffusion:x"
write = ["output", "lines"]

[pore-flood-fill]
write = true

[transient]
diffusivity = { lumen = 1, wall = 0.1 }
end-time = 1e-10
frames = 2
flux = true
write = true

[material]
young = { wall = 1e10 }
critical-stretch = { wall = 0.01 }

[equilibrium]
strain = 0.001
stress = true
strain-energy = true
write = true

[fracture]
at-broken = 20
stress = true
strain-energy = true
write = ["output", "broken"]

[stress-pdf]

[crack-path]
phases = "sample"

[dynamics]
density = 1500
end-time = 1e-8
strain-rate = 1
stress = true
write = true

[[compression]]
name = "press"
density = 1500
strain = 0.06
at-strain = 0.03
velocity = true
stress = true
deformation-gradient = true
energy-density = true
write = ["output", "curve"]

[compression-curve]

[collapse-map]
write = true

[bond-stiffness]

[[compression]]
name = "moduli"
stiffness-only = true

[[picture]]
of = "sample"
"""

VOLUME = """
[sample]
generate = "spheres"
size = [8, 8, 8]

[diffusion]
conductivity = { matrix = 1, inclusion = 2 }
direction = "x"

[flux-map]

[material]
young = { matrix = 1e10, inclusion = 2e10 }
mixing = "harmonic"
critical-stretch = { matrix = 0.01, inclusion = 0.01 }

[equilibrium]
strain = 0.001

[fracture]
max-broken = 100

[crack-path]

[bond-stiffness]
"""


def paths_of(value, path, found):
    """The path of every number of a report, as [measure] writes it."""
    if isinstance(value, dict):
        for key, item in value.items():
            paths_of(item, f"{path}.{key}", found)
    elif isinstance(value, list):
        for i, item in enumerate(value):
            if isinstance(item, dict):
                names = [item[key] for key in ("name", "phase", "axis", "direction") if isinstance(item.get(key), str)]
                paths_of(item, f"{path}.{names[0] if names else i}", found)
    elif isinstance(value, (int, float)):
        found.append(path)


class SceneWords(Case):
    def scene(self, text, name="scene.toml"):
        return self.write(name, text.encode("utf-8"))

    def refused(self, message, hint, *words, code=2):
        self.fails(code, message, hint, "run", "scene.toml", "--dry-run", *words)

    def everything_is_known(self, scene):
        """What a run of the scene reports and gives is what is known beforehand."""
        self.scene(scene)
        self.assertEqual(self.run_lamella("run", "scene.toml", "--quiet").code, 0)
        with open(glob.glob(self.path("scene.results/samples/*/record.json"))[0], encoding="utf-8") as file:
            stages = json.load(file)["stages"]
        found = []
        for name, report in stages.items():
            paths_of(report, name, found)
        text = scene + "\n[measure]\n" + "".join(f'm{i} = "{path}"\n' for i, path in enumerate(found))
        for file in sorted(glob.glob(self.path("scene.results/samples/*/*.vt[ip]"))):
            stage = os.path.basename(file).split(".")[0].split("_")[0]
            if stage in ("crack-path", "fracture") and file.endswith("broken.vtp") or "lines" in file:
                continue  # no data of points that a picture draws
            arrays = [array["name"] for array in self.works("info", file, "--json").json()["point_arrays"]]
            part = os.path.basename(file).split(".")[0][len(stage) + 1:] if stage == "diffusion" else ""
            for array in arrays:
                text += f'\n[[picture]]\nof = "{stage}{":" + part if part else ""}"\narray = "{array}"\nsize = [160, 160]\n'
        self.scene(text)
        plan = self.works("run", "scene.toml", "--dry-run", "--json").json()
        self.assertEqual(plan["fails"], [])
        self.assertGreater(len(found), 100)
        return found

    def test_all_reports_and_arrays_are_known(self):
        self.everything_is_known(ALL)

    def test_of_volumes_too(self):
        found = self.everything_is_known(VOLUME)
        self.assertIn("crack-path.counted_area", found)

    def test_phases(self):
        self.scene(ALL)
        for section, key in (("diffusion", "conductivity"), ("transient", "diffusivity"), ("equilibrium", "young"),
                             ("fracture", "critical-stretch"), ("dynamics", "young"), ("press", "young"), ("bond-stiffness", "young"),
                             ("moduli", "young")):
            with self.subTest(section):
                self.refused("'wal'", "did you mean 'wall'?", f"--{section}.{key}={{ lumen = 1, wall = 1, wal = 1 }}")
        self.refused("'lumn'", "did you mean 'lumen'?", "--dynamics.density=lumn=3")
        self.refused("phase 'lumen' has no conductivity", "give one to each phase", "--diffusion.conductivity={ wall = 1 }")
        self.scene(SAMPLE + '[diffusion]\nconductivity = { lumen = 0.1, wall = 1 }\n[[picture]]\nof = "sample"\nphase-color = { wal = "white" }\n')
        self.refused("'wal'", "wall", code=3)

    def test_measures(self):
        measure = ALL + '\n[measure]\nm = "%s"\n'
        for wrong, meant in (("fracture.peak_stres", "peak_stress"), ("fracture.first_break.strian", "strain"), ("diffusion.effective.u", "x"),
                             ("stress-pdf.tail.thet", "theta"), ("press.worst_energy", "worst_energy_ratio"),
                             ("sample.phases.wal.fraction", "wall"), ("equilibrium.phases.wal.fraction", "wall"), ("sample.sed", "seed"),
                             ("bond-stiffness.constants.E_x.valu", "value")):
            with self.subTest(wrong):
                self.scene(measure % wrong)
                self.refused("scene.toml:", meant)
        # a run says so, too, before it solves: nothing is left behind
        self.scene(measure % "stress-pdf.tail.thet")
        self.fails(2, "stress-pdf reports no 'tail.thet'", "did you mean 'theta'?", "run", "scene.toml")

    def test_arrays(self):
        picture = ALL + "\n[[picture]]\n"
        for lines, message, hint in (('of = "fracture"\narray = "damge"\n', "'damge', which fracture does not give", "'damage'"),
                                     ('of = "diffusion:y"\npreset = "stress"\n', "'stress', which diffusion", "temperature"),
                                     ('of = "sample"\narray = "phse"\n', "'phse'", "")):
            with self.subTest(lines):
                self.scene(picture + lines)
                self.refused(message, hint, code=3 if "sample" in lines else 2)
        self.scene(ALL + '\n[[each]]\nrun = "snapshot"\nof = "fracture"\narray = "dmage"\n')
        self.refused("'dmage', which fracture does not give", "did you mean 'damage'?")

    def test_options_of_what_comes_after_a_solve(self):
        self.scene(ALL)
        self.refused("component 'zz1'", "'zz'", "--stress-pdf.component=zz1")
        self.refused("share 7 is not below 1", "above 0 and below 1", "--collapse-map.share=7")
        self.refused("window -3 is below 0", "0 or more", "--compression-curve.window=-3")
        self.refused("takes one field, and [diffusion] gives one for each direction", 'of = "diffusion:x"', "--flux-map.of=diffusion")
        self.refused("'diffusion:u' is no direction", 'of = "diffusion:x"', "--flux-map.of=diffusion:u")
        self.scene(SAMPLE + '[fracture]\nyoung = { wall = 1e10 }\ncritical-stretch = { wall = 0.01 }\n[[each]]\nrun = "snapshot"\ncolor-map = "virdis"\n')
        self.refused("'virdis'", "did you mean 'viridis'?")

    def test_the_line_is_that_of_the_key(self):
        bonds = '[equilibrium]\nyoung = { wall = 1e10 }\n'
        for text, line, message in (
                (bonds + 'strain = 2\n', 9, "[equilibrium] strain 2 is not below 1"),  # a number out of its range
                (bonds + 'stress = true\nload = "strech"\n', 10, "[equilibrium] load 'strech' is none of its choices"),
                (bonds + 'strain = 0.001\nlateral-strain = 0.1\n', 10, "[equilibrium] lateral strain counts only with load biaxial"),
                ('[material]\nhorizon = 3\nyoung = { wal = 1e10 }\n[equilibrium]\nstrain = 0.001\n', 9, "'wal'"),
                ('[diffusion]\ndirection = "x"\nsides = "periodic"\nconductivity = { wall = 1 }\n', 10, "phase 'lumen' has no conductivity"),
                ('[fracture]\nyoung = { wall = 1e10 }\ncritical-stretch = { wall = 0.01 }\n[[each]]\nrun = "snapshot"\nsize = [90, 90]\ncolor-map = "virdis"\n',
                 13, "'virdis'"),
                (bonds + '[crack-path]\nhorizon = 3\nof = "equilibrium"\n', 11, "'equilibrium' gives no such thing"),
                (bonds + '[stress-pdf]\ncomponent = "xx"\nof = "equilibriun"\n', 11, "of: 'equilibriun' is no stage")):
            with self.subTest(text):
                self.scene(SAMPLE + text)
                result = self.run_lamella("run", "scene.toml", "--dry-run")
                self.assertEqual(result.code, 2, result.err)
                self.assertIn(f"scene.toml:{line}: ", result.err)
                self.assertIn(message, result.err)
        # two ways at once: the second
        self.scene('[sample]\nfile = "a.png"\nseed = 1\ngenerate = "softwood"\n')
        self.refused("scene.toml:4: [sample] has both", "give one of")

    def test_what_this_sample_does_not_let(self):
        # not a slip of the scene's: another sample of the sweep may be well
        self.scene(SAMPLE + "[diffusion]\nconductivity = { lumen = 0, wall = 0 }\n")
        self.assertIn("the first sample fails: scene.toml:7: [diffusion] no node of the picture conducts",
                      self.works("run", "scene.toml", "--dry-run").out)
        self.assertEqual(os.listdir(self.folder), ["scene.toml"])


if __name__ == "__main__":
    unittest.main()
