"""`-` for standard input and standard output."""

import json
import os
import pty
import signal
import subprocess
import time
import unittest

import grids
from program import CONDUCTIVITIES, MPIEXEC, PROGRAM, Case

CONDUCT = [*CONDUCTIVITIES, "--direction", "x"]


class Streams(Case):
    def send(self, data, *words, ranks=0):
        """Runs with these bytes as standard input: what comes back, as bytes."""
        launcher = [*MPIEXEC, str(ranks)] if ranks else []
        return subprocess.run([*launcher, PROGRAM, *words], input=data, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              timeout=100, check=False, env={**os.environ, "TMPDIR": self.kept})

    def setUp(self):
        super().setUp()
        self.kept = self.path("temporary")
        os.mkdir(self.kept)

    def tearDown(self):
        self.assertEqual(os.listdir(self.kept), [], "nothing is left")
        self.assertFalse([name for name in os.listdir(self.folder) if name.startswith("-")], "no file is called '-'")

    def out(self, data, *words, **options):
        done = self.send(data, *words, **options)
        self.assertEqual(done.returncode, 0, done.stderr.decode())
        return done.stdout

    def refused(self, code, message, hint, data, *words):
        done = self.send(data, *words)
        lines = done.stderr.decode().splitlines()
        self.assertEqual((done.returncode, done.stdout, len(lines)), (code, b"", 2), lines)
        self.assertIn(message, lines[0])
        self.assertIn(hint, lines[1])

    def test_from_command_to_command(self):
        tissue = self.out(b"", "generate", "softwood", "--size", "60,40", "-o", "-")
        self.write("t.vti", tissue)
        done = self.send(tissue, "diffusion", "-", *CONDUCT, "--json")
        report = json.loads(done.stdout)
        self.assertEqual(report["effective"], self.works("diffusion", "t.vti", *CONDUCT, "--json").json()["effective"])
        self.assertEqual(report["file"], "-")
        inputs = report["provenance"]["inputs"]
        self.assertEqual((inputs[0]["name"], inputs[0]["bytes"]), ("-", len(tissue)))
        # Each command's own format, and others by an ending; what people read goes to standard error then.
        field = self.send(tissue, "diffusion", "-", *CONDUCT, "-o", "-")
        self.assertIn(b'type="ImageData"', field.stdout)
        self.assertIn(b"wrote -.vti", field.stderr)
        picture = self.out(field.stdout, "snapshot", "-", "-o", "-", "--quiet")
        self.assertTrue(picture.startswith(b"\x89PNG"))
        self.assertTrue(self.out(b"", "generate", "softwood", "--size", "60,40", "-o", "-.png").startswith(b"\x89PNG"))
        grains = self.out(b"", "packing", "--count", "20", "-o", "-", "--quiet")
        self.assertIn(b'type="ImageData"', self.out(grains, "bridges", "-", "-o", "-", "--quiet"))

    def test_every_format_that_its_first_bytes_tell(self):
        self.works("generate", "softwood", "--size", "60,40", "-o", "t.vti")
        for ending in ["vti", "png", "tif", "npy", "nrrd", "mha", "hdf"]:
            data = self.out(b"", "convert", "t.vti", "-o", "-." + ending, "--quiet")
            self.out(data, "convert", "-", "-o", "x.raw", "--overwrite")
            with open(self.path("x.raw"), "rb") as file:
                self.assertEqual(len(set(file.read())), 2, ending)
        raw = self.out(b"", "convert", "t.vti", "-o", "-.raw", "--quiet")
        info = json.loads(self.out(raw, "info", "-", "--raw-size", "60,40,1", "--json"))
        self.assertEqual((info["file"], info["size"]), ("-", [60, 40, 1]))
        table = self.out(b"", "convert", "t.vti", "-o", "-.csv", "--quiet")
        self.assertEqual(json.loads(self.out(table, "info", "-", "--json"))["kind"], "vtkPolyData")  # a table without its notes

    def test_tables(self):
        curve = "strain,stress\n" + "".join("%g,%g\n" % (0.02 * i, 1e6 * min(0.02 * i, 0.1) + 1e8 * max(0, 0.02 * i - 0.6) ** 2) for i in range(40))
        table = self.out(curve.encode(), "compression-curve", "-", "-o", "-", "--quiet")
        self.assertEqual((table[:6], table.count(b"\n")), (b"strain", 41))

    def test_on_several_ranks(self):
        tissue = self.out(b"", "generate", "softwood", "--size", "60,40", "-o", "-")
        self.write("t.vti", tissue)
        report = json.loads(self.out(tissue, "diffusion", "-", *CONDUCT, "--json", ranks=2))
        expected = self.works("diffusion", "t.vti", *CONDUCT, "--json").json()
        self.assertAlmostEqual(report["effective"]["x"], expected["effective"]["x"], 9)

    def test_what_cannot_be(self):
        tissue = self.out(b"", "generate", "softwood", "--size", "60,40", "-o", "-")
        self.refused(2, "--json and -o both write to standard output", "leave --json out", tissue, "diffusion", "-", *CONDUCT, "-o", "-", "--json")
        self.refused(2, "two results are to be written to standard output", "a name of its own", tissue, "diffusion", "-", *CONDUCTIVITIES, "-o", "-")
        self.refused(2, "two results are to be written to standard output", "a name of its own", tissue, "convert", "-", "-o", "-.mhd")
        self.refused(2, "-o and --curve are both", "name of a file", tissue, "transient", "-", "-o", "-", "--curve", "-")
        self.refused(2, "--lines '-'", "name of a file", tissue, "snapshot", "-", "--lines", "-", "-o", "x.png")
        self.refused(2, "-o and --truth are both", "name of a file", b"", "generate", "hardwood", "--look", "blue", "-o", "-.png", "--truth", "-")
        self.refused(2, "SCENE '-'", "name of a file", b"", "run", "-")
        self.refused(3, "nothing came from it", "the program before it", b"", "info", "-")
        self.refused(3, "of no format that its first bytes tell", "--raw-size", b"\x01\x02\x03", "info", "-")
        self.refused(3, "'-' is not a .vti file, or is cut short", "again", grids.vti()[:100], "info", "-")
        self.refused(2, "a PNG holds one picture", ".vti", b"", "generate", "spheres", "-o", "-.png")

    def test_no_bytes_on_a_terminal(self):
        control, terminal = pty.openpty()
        self.addCleanup(os.close, control)
        for words, keywords in [(["generate", "spheres", "-o", "-"], {"stdout": terminal, "stdin": subprocess.DEVNULL}),
                                (["info", "-"], {"stdin": terminal, "stdout": subprocess.DEVNULL})]:
            done = subprocess.run([PROGRAM, *words], cwd=self.folder, stderr=subprocess.PIPE, timeout=100, check=False, **keywords)
            self.assertIn(done.returncode, (3, 7))
            self.assertIn(b"is a terminal", done.stderr.splitlines()[0])
        os.close(terminal)

    def test_an_interrupted_reader_leaves_nothing(self):
        process = subprocess.Popen([PROGRAM, "info", "-"], cwd=self.folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, env={**os.environ, "TMPDIR": self.kept})
        process.stdin.write(grids.vti() + bytes(2000))
        process.stdin.flush()
        while not os.listdir(self.kept):
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        _, error = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 130, error)

    def test_a_reader_that_stops_leaves_nothing(self):
        # 4 MB, more than a pipe holds
        first = subprocess.Popen([PROGRAM, "generate", "checkerboard", "--size", "400,400,40", "-o", "-.tif", "--quiet"], cwd=self.folder,
                                 stdout=subprocess.PIPE, env={**os.environ, "TMPDIR": self.kept})
        first.stdout.read(4)
        first.stdout.close()
        first.wait(timeout=100)


if __name__ == "__main__":
    unittest.main()
