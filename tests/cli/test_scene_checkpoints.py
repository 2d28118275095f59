"""lamella run: samples that are stopped on their way go on where their solver stood, to the same tables."""

import json
import os
import re
import signal
import subprocess
import time
import unittest

import program
import theora
from program import Case

# each a second or more, with several places for checkpoints; without [measure] all numbers are columns
SOLVERS = {
    "fracture": """
checkpoint = 0
[sample]
generate = "checkerboard"
size = [100, 60]
[fracture]
young = { matrix = 1e9, inclusion = 4e9 }
critical-stretch = { matrix = 0.01, inclusion = 0.02 }
like = ["matrix-inclusion=matrix"]
at-broken = "200..1800 step 200"
[[each]]
name = "pdf"
run = "stress-pdf"
[[each]]
name = "crack"
run = "crack-path"
every = 2
[[each]]
name = "film"
run = "snapshot"
preset = "auto"
array = "damage"
range = [0, 1]
size = [200, 200]
every = 3
movie = "damage.ogv"
[crack-path]
""",
    "dynamics": """
checkpoint = "0s"
[sample]
generate = "checkerboard"
size = [60, 40]
pixel-size = "1mm"
[dynamics]
young = { matrix = 7e10, inclusion = 7e10 }
like = ["matrix-inclusion=matrix"]
density = 2700
toughness = { matrix = 1e6, inclusion = 1e6 }
notch = "0,20mm,30mm,20mm"
traction = ["y+=0,2e6", "y-=0,-2e6"]
end-time = 1e-3
frames = 12
[[each]]
name = "pdf"
run = "stress-pdf"
[[each]]
name = "crack"
run = "crack-path"
""",
    "transient": """
checkpoint = 0
[sample]
generate = "softwood"
size = [40, 30]
[transient]
diffusivity = { lumen = 2e-5, wall = 2e-7 }
at-step = "10000..100000 step 10000"
[[each]]
name = "map"
run = "flux-map"
""",
    "compression": """
checkpoint = 0
[sample]
generate = "softwood"
size = [30, 30]
solid-fraction = 0.45
[compression]
strain = 0.25
at-strain = "0.02..0.24 step 0.02"
[[each]]
name = "pdf"
run = "stress-pdf"
[compression-curve]
""",
}


class SceneCheckpoints(Case):
    def files(self, folder, ending):
        return [os.path.join(at, name) for at, _, names in os.walk(self.path(folder)) for name in names if name.endswith(ending)]

    def tables(self, folder):
        """Tables but that of times, and pictures of steps."""
        found = {}
        for name in os.listdir(self.path(folder)):
            if name.endswith(".csv") and name != "times.csv":
                with open(self.path(os.path.join(folder, name)), "rb") as file:
                    found[name] = file.read()
        for path in self.files(folder, ".ogv"):
            found[os.path.basename(path)] = theora.Film(path).frames()
        return found

    def record(self, folder):
        (path,) = self.files(folder, "record.json")
        with open(path, encoding="utf-8") as file:
            return json.load(file)

    def stop(self, how, folder="part", checkpoints=1):
        """Runs until so many checkpoints were written, and ends it so."""
        run = subprocess.Popen([program.PROGRAM, "run", "scene.toml", "--results", folder], cwd=self.folder,
                               stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        seen = set()
        while run.poll() is None and len(seen) < checkpoints:
            for path in self.files(folder, ".checkpoint.h5"):
                try:
                    seen.add(os.stat(path).st_mtime_ns)
                except FileNotFoundError:
                    pass  # finished
            time.sleep(0.002)
        run.send_signal(how)
        error = run.communicate(timeout=60)[1].decode()
        self.assertEqual(run.returncode, 130 if how == signal.SIGINT else -how, error)
        return error

    def goes_on(self, name, whole, folder="part", anew=False):
        run = self.run_lamella("run", "scene.toml", "--results", folder, "--json")
        self.assertEqual(run.code, 0, run.err)
        record = self.record(folder)
        at = record["stages"][name]["continued_at"]
        self.assertTrue(at == 0 if anew else at > 0, at)
        self.assertEqual(record["warnings"], whole["warnings"])
        self.assertEqual(self.tables(folder), self.tables("whole"))
        self.assertEqual(self.files(folder, ".h5"), [self.path(folder + "/results.h5")])  # no checkpoint stays
        self.assertEqual(self.files(folder, ".jsonl"), [])

    def test_stopped_samples_go_on(self):
        for name, text in SOLVERS.items():
            with self.subTest(name):
                self.write("scene.toml", text.encode())
                for folder in ("whole", "part"):
                    subprocess.run(["rm", "-rf", self.path(folder)], check=True)
                self.assertEqual(self.run_lamella("run", "scene.toml", "--results", "whole", "--set", "checkpoint=false").code, 0)
                whole = self.record("whole")
                self.assertEqual(whole["stages"][name]["checkpoints"], 0)
                self.assertGreater(len(self.tables("whole")), 1)
                error = self.stop(signal.SIGINT)
                self.assertIn("and from the checkpoint of 1 that is not", error)
                self.assertNotIn("--continue", error)
                self.stop(signal.SIGKILL)
                self.goes_on(name, whole)

    def test_what_does_not_fit_begins_anew(self):
        self.write("scene.toml", SOLVERS["fracture"].encode())
        self.run_lamella("run", "scene.toml", "--results", "whole", "--set", "checkpoint=false")
        whole = self.record("whole")
        self.stop(signal.SIGKILL)
        (path,) = self.files("part", ".checkpoint.h5")
        with open(path, "r+b") as file:  # damaged
            file.seek(-100, os.SEEK_END)
            file.write(b"x" * 50)
        self.goes_on("fracture", whole, anew=True)
        self.stop(signal.SIGKILL, "other", 2)
        for picture in self.files("other", ".png"):
            os.remove(picture)
        self.goes_on("fracture", whole, "other", anew=True)

    def test_states_that_are_all_wanted_have_none(self):
        text = SOLVERS["fracture"].replace("at-broken", "write = true\nat-broken").replace("1800", "800") + "max-broken = 900\n"
        text = re.sub(r"\[crack-path\]\nmax-broken = 900\n", "", text).replace("[fracture]", "[fracture]\nmax-broken = 900")
        self.write("scene.toml", text.encode())
        self.assertEqual(self.run_lamella("run", "scene.toml", "--quiet").err, "")
        self.assertEqual(self.record("scene.results")["stages"]["fracture"]["checkpoints"], 0)
        self.assertEqual(len(self.files("scene.results", ".vti")), 5)

    def test_bad_times(self):
        for value in ('"soon"', "-1", "true", "[1]", '"10 parsecs"'):
            self.write("scene.toml", f"checkpoint = {value}\n".encode() + SOLVERS["transient"].encode().replace(b"checkpoint = 0\n", b""))
            self.fails(2, "scene.toml:1: checkpoint = ", '"10min"', "run", "scene.toml")


if __name__ == "__main__":
    unittest.main()
