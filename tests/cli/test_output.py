"""Files: whole or not at all, never over another one, with their provenance."""

import glob
import hashlib
import os
import resource
import signal
import subprocess
import time
import unittest

import pictures
from program import CONDUCTIVITIES, MPIEXEC, PHASES, PROGRAM, Case

PICTURE = pictures.png(pictures.stripes(40, 30, bands=8), pixels_per_metre=2000000)


class Whole(Case):
    def setUp(self):
        super().setUp()
        self.write("p.png", PICTURE)
        self.solve = ["diffusion", "p.png", *PHASES, *CONDUCTIVITIES]

    def test_nothing_is_overwritten_without_leave(self):
        self.write("a.vti", b"precious")
        self.write("a_y.vti", b"precious")
        self.fails(7, "'a_y.vti' exists already", "--overwrite", *self.solve, "-o", "a.vti")
        self.fails(7, "'a.vti' exists already", "--overwrite", *self.solve, "--direction", "x", "-o", "a.vti")
        self.write("a.png", b"precious")
        self.fails(7, "'a.png' exists already", "--overwrite", "generate", "softwood", "-o", "a.png")
        self.write("a.raw.json", b"precious")
        self.fails(7, "'a.raw.json' exists already", "--overwrite", "generate", "spheres", "-o", "a.raw")
        self.fails(7, "'a.png' exists already", "--overwrite", "snapshot", "p.png", *PHASES, "-o", "a.png")
        for name in ["a.vti", "a_y.vti", "a.png", "a.raw.json"]:
            with open(self.path(name), "rb") as file:
                self.assertEqual(file.read(), b"precious")
        self.works(*self.solve, "-o", "a.vti", "--overwrite")
        self.assertEqual(self.info("a_y.vti")["field_data"]["direction"], "y")
        self.works("generate", "softwood", "-o", "a.png", "--overwrite")
        self.assertEqual(self.info("a.png")["kind"], "picture")

    def test_one_file_a_direction(self):
        self.works(*self.solve, "-o", "a.vti")
        self.assertEqual(sorted(os.listdir(self.folder)), ["a_x.vti", "a_y.vti", "p.png"])
        self.works(*self.solve, "-o", "b.vti", "--direction", "y")
        self.assertTrue(os.path.exists(self.path("b.vti")))

    def test_a_folder_that_cannot_be_written_is_noticed_at_once(self):
        self.fails(7, "there is no folder 'deep'", "mkdir -p deep", *self.solve, "-o", "deep/a.vti")
        # /proc takes no files, not even root's.
        self.fails(7, "cannot write in the folder '/proc'", "choose a folder", *self.solve, "-o", "/proc/a.vti")
        self.fails(7, "cannot write in the folder '/proc'", "choose a folder", "generate", "disks", "-o", "/proc/a.png")
        if os.geteuid() != 0:
            os.mkdir(self.path("locked"), 0o555)
            self.fails(7, "cannot write in the folder 'locked'", "choose a folder", *self.solve, "-o", "locked/a.vti")
        self.fails(2, "fields are written as .vti", ".vti", *self.solve, "-o", "a.png")
        os.mkdir(self.path("d.vti"))
        self.fails(7, "'d.vti' is a folder", "name of a file", *self.solve, "--direction", "x", "-o", "d.vti")

    def test_a_full_disk(self):
        # A limit on the size of files stops a write half-way, as a full disk does.
        self.works("generate", "softwood", "--size", "120,100", "-o", "t.png")
        self.works("diffusion", "t.png", *CONDUCTIVITIES, "-o", "h.vti", "--direction", "y")

        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))

        for words in [
            ["diffusion", "t.png", *CONDUCTIVITIES, "-o", "a.vti"],
            ["generate", "softwood", "--size", "600,600", "-o", "a.tif"],  # packed, still above the limit
            ["generate", "softwood", "-o", "a.vti"],
            ["generate", "spheres", "-o", "a.raw"],
            ["flux-map", "h.vti", "-o", "a.vti"],
            ["pore-flood-fill", "t.png", "-o", "a.vti"],
            ["flux-map", "h.vti", "-o", "a.vtp"],
            ["snapshot", "h.vti", "-o", "a.png"],
        ]:
            self.fails(7, "File too large", "", *words, preexec_fn=limit)

    @unittest.skipUnless(os.geteuid() == 0, "only root can mount a small disk")
    def test_a_full_disk_mounted(self):
        os.mkdir(self.path("small"))
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=200k", "none", self.path("small")], check=False,
                                 stderr=subprocess.DEVNULL)
        if mounted.returncode != 0:
            self.skipTest("cannot mount a small disk here")
        self.addCleanup(subprocess.run, ["umount", self.path("small")], check=False)
        self.fails(7, "No space left on device", "room", "generate", "spheres", "--size", "90,90,90", "-o", "small/a.raw")
        # The fields of a solve are known to be too large before the solve.
        self.works("generate", "softwood", "-o", "t.png")
        self.fails(7, "can take up to 1.3 MB", "room", "diffusion", "t.png", *CONDUCTIVITIES, "-o", "small/a.vti")
        self.assertEqual(os.listdir(self.path("small")), [])

    def test_standard_output_on_a_full_disk(self):
        with open("/dev/full", "w", encoding="ascii") as full:
            done = subprocess.run([PROGRAM, "info", "p.png"], cwd=self.folder, stdout=full, stderr=subprocess.PIPE, check=False)
        self.assertEqual(done.returncode, 7)
        self.assertIn(b"cannot write the result to standard output", done.stderr)


class Interrupted(Case):
    def interrupt(self, number, launcher=()):
        """Starts a solve that takes some seconds, and sends a signal once its output is open."""
        self.works("generate", "softwood", "--size", "1200,1200", "-o", "t.png")
        words = [*launcher, PROGRAM, "diffusion", "t.png", "--conductivity", "lumen=0.02", "--conductivity", "wall=1"]
        with subprocess.Popen([*words, "-o", "a.vti"], cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              start_new_session=True) as process:
            begin = time.time()
            while not glob.glob(self.path(".lamella-*")) and process.poll() is None and time.time() < begin + 60:
                time.sleep(0.01)
            running = process.poll() is None
            process.send_signal(number)
            out, err = process.communicate(timeout=60)
        self.assertTrue(running, err.decode("utf-8", "replace"))
        self.assertEqual(out, b"")
        # mpirun stops the ranks itself when they take longer than it likes; what counts is what is left.
        for _ in range(100):
            if os.listdir(self.folder) == ["t.png"]:
                break
            time.sleep(0.05)
        self.assertEqual(os.listdir(self.folder), ["t.png"], "neither a result nor a part of one")
        return process.returncode, err.decode()

    def test_control_c_leaves_no_half_file(self):
        code, err = self.interrupt(signal.SIGINT)
        self.assertEqual(code, 130)
        self.assertIn("error: interrupted", err)
        self.assertIn("hint: nothing was written", err)

    def test_termination_too(self):
        code, err = self.interrupt(signal.SIGTERM)
        self.assertEqual(code, 143)
        self.assertIn("error: interrupted", err)

    def test_on_two_ranks(self):
        code, _ = self.interrupt(signal.SIGINT, [*MPIEXEC, "2"])
        self.assertNotEqual(code, 0)


class Provenance(Case):
    def test_every_output_tells_where_it_comes_from(self):
        environment = {"SOURCE_DATE_EPOCH": "1700000000"}
        for name in ["t.png", "t.tif", "t.vti", "v.raw", "v.tif", "v.vti"]:
            size = ["--size", "30,30,30", "--pixel-size", "2um"] if name.startswith("v") else ["--size", "60,50"]
            self.works("generate", "softwood", *size, "--seed", "7", "-o", name, environment=environment)
            record = self.info(name)["provenance"]
            self.assertEqual(record["program"], "lamella")
            self.assertRegex(record["version"], r"^\d+\.\d+\.\d+")
            self.assertEqual(record["seed"], 7)
            self.assertEqual(record["date"], "2023-11-14T22:13:20Z")
            self.assertEqual(record["command"], "lamella generate softwood %s --seed 7 -o %s" % (" ".join(size), name))
            self.assertIn("seed       7", self.works("info", name).out)

    def test_inputs_with_size_and_hash_and_what_they_were_made_from(self):
        self.works("generate", "softwood", "--seed", "7", "-o", "t.png")
        self.works("diffusion", "t.png", *CONDUCTIVITIES, "--direction", "y", "-o", "h.vti")
        self.works("flux-map", "h.vti", "-o", "m.vti", "-o", "l.vtp")
        self.works("snapshot", "h.vti", "-o", "s.png")
        with open(self.path("t.png"), "rb") as file:
            data = file.read()
        for name, made in [("h.vti", "t.png"), ("m.vti", "h.vti"), ("l.vtp", "h.vti"), ("s.png", "h.vti")]:
            record = self.info(name)["provenance"]
            self.assertEqual(record["inputs"][0]["name"], made)
            self.assertEqual(record["seed"], 7, "the seed of the sample goes on")
            if made == "t.png":
                self.assertEqual(record["inputs"][0]["bytes"], len(data))
                self.assertEqual(record["inputs"][0]["sha256"], hashlib.sha256(data).hexdigest())
            self.assertIn("lamella generate softwood", str(record["parameters"]["made_from"]))
        self.assertIn("made from", self.works("info", "s.png").out)

    def test_a_command_line_that_a_shell_reads_back(self):
        self.write("my picture's.png", PICTURE)
        self.works("diffusion", "my picture's.png", *PHASES, *CONDUCTIVITIES, "--direction", "x", "-o", "h.vti")
        self.assertIn(r"'my picture'\''s.png'", self.info("h.vti")["provenance"]["command"])

    def test_the_same_again_byte_for_byte(self):
        environment = {"SOURCE_DATE_EPOCH": "1700000000"}
        data = []
        for _ in range(2):
            self.works("generate", "softwood", "--seed", "3", "-o", "t.png", "--overwrite", environment=environment)
            with open(self.path("t.png"), "rb") as file:
                data.append(file.read())
        self.assertEqual(data[0], data[1])

    def test_files_of_others_have_none(self):
        self.write("p.png", PICTURE)
        self.assertIsNone(self.info("p.png")["provenance"])
        self.assertIn("lamella did not write this file", self.works("info", "p.png").out)


class Terminal(Case):
    def test_progress_is_for_terminals_only(self):
        self.works("generate", "softwood", "--size", "700,700", "-o", "t.png")
        words = [PROGRAM, "diffusion", "t.png", "--conductivity", "lumen=0.02", "--conductivity", "wall=1"]
        # In a pipe nothing: works() has seen to that. On a terminal a bar that goes away again.
        self.works(*words[1:])
        mother, child = os.openpty()
        with subprocess.Popen(words, cwd=self.folder, stdout=subprocess.PIPE, stderr=child) as process:
            os.close(child)
            seen = b""
            while True:
                try:
                    piece = os.read(mother, 4096)
                except OSError:  # the other end is closed
                    break
                if not piece:
                    break
                seen += piece
            out, _ = process.communicate(timeout=60)
        os.close(mother)
        self.assertEqual(process.returncode, 0)
        self.assertNotIn(b"\r", out)
        if b"[" in seen:  # a machine may be done before half a second is over
            self.assertRegex(seen, rb"\r\[[#.]*\] +\d+ %")
            self.assertTrue(seen.endswith(b"\r\x1b[K"))


if __name__ == "__main__":
    unittest.main()
