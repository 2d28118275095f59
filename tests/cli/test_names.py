"""Phases have one set of names: what a command prints, every other command takes."""

import unittest

import program

TISSUE = {"lumen", "wall", "middle lamella"}
GRAINS = {"void", "matrix", "grain"}
OPEN = {"lumen", "void"}


class Names(program.Case):
    def phases(self, name):
        info = self.info(name)
        return [one["name"] for one in info["phases"]] if "phases" in info else [one["name"] for one in info["greys"]]

    def samples(self):
        """{file: the set its names are of}"""
        self.works("generate", "softwood", "--size", "72,64", "-o", "soft.png")
        self.works("generate", "softwood", "--size", "72,64", "-o", "soft.vti")
        self.works("generate", "hardwood", "--size", "240,200", "--pixel-size", "0.5um", "--look", "blue", "-o", "scan.png")
        self.run_lamella("micrograph", "scan.png", "--window", "0,0,120,100", "-o", "seen.vti")
        self.run_lamella("micrograph", "soft.png", "--lamella", "constant", "--lamella-thickness", "2um", "-o", "seen.png")
        self.run_lamella("micrograph", "soft.png", "--lamella", "none", "-o", "outlines.vti")
        self.run_lamella("diffusion", "scan.png", "--segment", "--window", "0,0,100,80", "--conductivity", "lumen=1,wall=1", "--direction", "x",
                         "--no-error-estimate", "-o", "segmented.vti")
        self.run_lamella("packing", "--count", "20", "-o", "grains.vtp")  # warns of so few
        self.works("bridges", "grains.vtp", "--saturation", "0.5", "--nodes", "48", "-o", "bridges.vti")
        self.works("bridges", "grains.vtp", "--saturation", "0.5", "--nodes", "48", "-o", "bridges.png")
        self.works("convert", "soft.vti", "-o", "converted.vti", "--overwrite")
        return {name: GRAINS if name.startswith("bridges") else TISSUE
                for name in ("soft.png", "soft.vti", "seen.vti", "seen.png", "outlines.vti", "segmented.vti", "converted.vti",
                             "bridges.vti", "bridges.png")}

    def test_what_is_printed_is_taken(self):
        for name, known in self.samples().items():
            with self.subTest(name):
                phases = self.phases(name)
                self.assertGreaterEqual(len(phases), 2)
                self.assertLessEqual(set(phases), known)
                solid = [phase for phase in phases if phase not in OPEN]
                every = ",".join(f"{phase}=1" for phase in phases)
                walls = ["--young", ",".join(f"{phase}=1e9" for phase in solid), "--mixing", "harmonic"]
                breaks = ["--critical-stretch", ",".join(f"{phase}=0.01" for phase in solid), "--max-broken", "3"]
                runs = (
                    ("diffusion", name, "--conductivity", every, "--no-error-estimate", "--direction", "x"),
                    ("transient", name, "--diffusivity", every.replace("=1", "=1e-7"), "--at-step", "4"),
                    ("equilibrium", name, *walls, "--stress", "-o", "loaded.vti", "--overwrite"),
                    ("stress-pdf", "loaded.vti", "--phase", solid[0]),
                    ("bond-stiffness", name, *walls, "--no-error-estimate"),
                    ("fracture", name, *walls, *breaks),
                    ("dynamics", name, *walls, "--density", "1000", "--velocity", "y+=0,1", "--end-time", "1e-9"),
                    ("compression", name, "--stiffness-only", "--young", ",".join(f"{phase}=1e9" for phase in solid)),
                    ("pore-flood-fill", name, "--fill", phases[0]),
                    ("snapshot", name, "--phase-color", f"{phases[0]}=#ffffff", "-o", "picture.png", "--overwrite"),
                )
                # every command on one sample of each set of names; of the others what they are read with is looked at
                for run in runs if name in ("soft.png", "seen.vti", "bridges.vti") else runs[:1]:
                    result = self.run_lamella(*run, "--quiet")
                    # a small sample may hold nothing to load; a name that is not known is refused as such
                    self.assertIn(result.code, (0, 4), f"{run}\n{result.err}")
                if known is TISSUE and name in ("soft.png", "seen.vti", "segmented.vti"):
                    result = self.run_lamella("micrograph", name, "--lumen-phase", phases[0], "--lamella", "none", "--quiet")
                    self.assertEqual(result.code, 0, result.err)

    def test_the_readme_s_chain(self):
        self.works("generate", "hardwood", "--size", "400,300", "--pixel-size", "0.5um", "--look", "blue", "-o", "scan.png")
        seen = self.run_lamella("micrograph", "scan.png", "--conductivity", "lumen=0.05,wall=1", "-o", "tissue.vti")
        self.assertEqual(seen.code, 0, seen.err)
        self.works("diffusion", "tissue.vti", "--conductivity", "lumen=0.05,wall=1,middle lamella=1", "--no-error-estimate")

    def test_other_words_for_the_same(self):
        self.works("generate", "softwood", "--size", "64,64", "-o", "new.png")
        names = lambda lumen, wall: ["new.png", "--phase", "0=" + lumen, "--phase", "255=" + wall]
        solve = ["--direction", "x", "--no-error-estimate", "--json"]
        plain = self.works("diffusion", "new.png", "--conductivity", "lumen=0.1,wall=1", *solve).json()["effective"]
        for sample, said in ((["new.png"], "secondary wall=1e9"), (names("void", "secondary wall"), "wall=1e9"), (names("pore", "wall"), "wall=1e9")):
            for words in ("lumen=0.1,wall=1", "void=0.1,secondary wall=1", "air=0.1,wall=1"):
                answer = self.works("diffusion", *sample, "--conductivity", words, *solve).json()
                self.assertEqual(answer["effective"], plain, words)
            for words in (said,):
                self.works("equilibrium", *sample, "--young", words, "--void", "pore", "--quiet")
                self.works("compression", *sample, "--stiffness-only", "--young", words, "--quiet")
                moves = self.run_lamella("dynamics", *sample, "--young", words, "--density", words.replace("1e9", "700"),
                                         "--velocity", "y+=0,1", "--end-time", "1e-9", "--quiet")
                self.assertEqual(moves.code, 0, moves.err)
            self.works("pore-flood-fill", *sample, "--fill", "air", "--quiet")
        # nothing is taken for another word where it is none, or where it could be two
        self.fails(2, "names 'solid'", "its phases are", "diffusion", "new.png", "--conductivity", "lumen=0.1,solid=1")
        two = ["diffusion", *names("void", "air"), "--conductivity"]
        self.fails(2, "names 'lumen'", "its phases are", *two, "lumen=0.1,void=1")
        # the phase's own name wins
        own = self.works(*two, "void=1,air=0.5", "--json").json()
        self.assertEqual({p["name"]: p["conductivity"] for p in own["phases"]}, {"void": 1, "air": 0.5})


if __name__ == "__main__":
    unittest.main()
