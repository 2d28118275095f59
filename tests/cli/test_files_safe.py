"""Files that runs leave, lose or lock: names given twice, killed runs, links, folders of results, limits of memory."""

import glob
import hashlib
import os
import resource
import signal
import socket
import struct
import subprocess
import time
import unittest

import pictures
from program import CONDUCTIVITIES, PHASES, PROGRAM, Case

SCENE = b'[sample]\ngenerate = "honeycomb"\nsize = [32, 32]\n[diffusion]\nconductivity = { lumen = 0.1, wall = 1 }\n'


def here():
    """What stands for this machine in the names of temporary files (solvers/core/PartFile.cpp)."""
    value = 2166136261
    for byte in (socket.gethostname() + os.readlink("/proc/self/ns/pid")).encode():
        value = (value ^ byte) * 16777619 % 2**32
    return "%08x" % value


class Names(Case):
    def setUp(self):
        super().setUp()
        self.write("p.png", pictures.png(pictures.stripes(40, 30, bands=8), pixels_per_metre=2000000))

    def test_two_results_of_one_name(self):
        twice = "two results are to be written to '%s'"
        pores = ["pore-flood-fill", "p.png", "--phase", "0=void", "--other", "solid"]
        self.fails(2, twice % "t.csv", "of its own", *pores, "-o", "t.csv", "--distribution", "t.csv")
        self.fails(2, twice % "./t.csv", "of its own", *pores, "-o", "t.csv", "--distribution", "./t.csv", "--overwrite")
        self.works("generate", "honeycomb", "--size", "48,48", "-o", "h.png")
        self.fails(2, twice % "s.csv", "of its own", "bond-stiffness", "h.png", "--young", "wall=1e9", "-o", "s.csv", "--constants",
                   "s.csv")
        os.symlink(".", self.path("same"))
        self.fails(2, twice % "same/t.csv", "of its own", *pores, "-o", "t.csv", "--distribution", "same/t.csv")

    def test_the_input_may_be_replaced(self):
        self.works("diffusion", "p.png", *PHASES, *CONDUCTIVITIES, "--direction", "x", "-o", "k.vti")
        with open(self.path("k.vti"), "rb") as file:
            before = hashlib.sha256(file.read()).hexdigest()
        self.fails(7, "'k.vti' exists already", "--overwrite", "flux-map", "k.vti", "-o", "k.vti")
        self.works("flux-map", "k.vti", "-o", "k.vti", "--overwrite")
        self.assertIn(before, str(self.info("k.vti")["provenance"]), "the record names the input as it was")

    def test_what_killed_runs_leave_is_removed(self):
        with subprocess.Popen(["true"]) as process:
            process.wait()
        orphan = subprocess.Popen(["true"])
        self.addCleanup(orphan.wait)
        os.waitid(os.P_PID, orphan.pid, os.WEXITED | os.WNOWAIT)  # it has ended, and nobody has asked how
        dead = ".lamella-%s-%d-0-k.vti" % (here(), process.pid)
        unasked = ".lamella-%s-%d-0-k.vti" % (here(), orphan.pid)
        mine = ".lamella-%s-%d-0-k.vti" % (here(), os.getpid())
        others = ".lamella-%s-%d-0-k.vti" % ("00000000" if here() != "00000000" else "1" * 8, process.pid)
        for name in [dead, unasked, mine, others, ".lamella-x", "precious"]:
            self.write(name, b"part")
        self.works("generate", "honeycomb", "--size", "32,32", "-o", "h.png")
        self.assertEqual(sorted(os.listdir(self.folder)), sorted([mine, others, ".lamella-x", "precious", "p.png", "h.png"]))

    def test_a_kill_leaves_a_name_that_the_next_run_removes(self):
        self.works("generate", "softwood", "--size", "1000,1000", "-o", "t.png")
        words = ["diffusion", "t.png", "--conductivity", "lumen=0.02", "--conductivity", "wall=1", "-o", "a.vti"]
        with self.popen(*words) as process:
            begin = time.time()
            while not glob.glob(self.path(".lamella-*")) and process.poll() is None and time.time() < begin + 60:
                time.sleep(0.01)
            process.kill()
            process.communicate()
        self.assertNotEqual(glob.glob(self.path(".lamella-*")), [])
        self.works("generate", "honeycomb", "--size", "32,32", "-o", "h.png")
        self.assertEqual(glob.glob(self.path(".lamella-*")), [])

    def test_slices_after_control_c(self):
        self.works("generate", "spheres", "--size", "64,64,64", "-o", "s.vti")
        os.mkdir(self.path("cut"))
        for wait in [0.02, 0.05, 0.1, 0.2, 0.3, 0.4]:  # the last ones while all slices take their places
            with self.popen("convert", "s.vti", "-o", "cut/s_%04d.png") as process:
                begin = time.time()
                while not glob.glob(self.path("cut/.lamella-*")) and process.poll() is None and time.time() < begin + 60:
                    time.sleep(0.002)
                time.sleep(wait)
                process.send_signal(signal.SIGINT)
                process.communicate(timeout=60)
            self.assertEqual(glob.glob(self.path("cut/.*")), [])
            if process.returncode == 0:
                self.assertEqual(len(os.listdir(self.path("cut"))), 64)
                break
            self.assertEqual(os.listdir(self.path("cut")), [])

    def test_links_in_the_place_of_temporary_files(self):
        self.write("precious", b"precious")
        os.symlink("precious", self.path(".c.h5.part"))  # the name that it once had
        self.works("generate", "honeycomb", "--size", "48,48", "-o", "h.png")
        self.works("transient", "h.png", "--diffusivity", "wall=1e-9", "--diffusivity", "lumen=2e-9", "--end-time", "0.001",
                   "--checkpoint", "c.h5")
        with open(self.path("precious"), "rb") as file:
            self.assertEqual(file.read(), b"precious")
        self.assertEqual(self.works("info", "c.h5", "--json").json()["kind"], "checkpoint")

    def test_report_shows_nothing_from_outside(self):
        os.makedirs(self.path("results/in"))
        os.mkdir(self.path("outside"))
        self.write("outside/private.csv", b"a,b\n11111,22222\n")
        self.write("outside/private.json", b'{"secret": "33333"}')
        self.write("results/in/shown.csv", b"a,b\n44444,1\n")
        for link, to in [("private.csv", "../outside/private.csv"), ("private.json", "../outside/private.json"),
                         ("private.png", "../p.png"), ("shown.csv", "in/shown.csv"), ("shown.csv.json", "../outside/private.json")]:
            os.symlink(to, self.path("results/" + link))
        said = self.run_lamella("report", "results", "--json").json()
        self.assertEqual(len(said["problems"]), 4, said["problems"])
        self.assertIn("link out of the folder", said["problems"][0])
        with open(self.path("results/report.html"), encoding="utf-8") as file:
            page = file.read()
        self.assertIn("44444", page)
        for secret in ["11111", "33333", "data:image"]:
            self.assertNotIn(secret, page)


class Folders(Case):
    def setUp(self):
        super().setUp()
        self.write("s.toml", SCENE)

    def test_a_folder_that_a_run_just_began(self):
        os.makedirs(self.path("r/samples"))
        self.write("r/.lamella-00000000-1-0-lamella-results.json", b"")
        self.works("run", "s.toml", "--results", "r")
        os.mkdir(self.path("mine"))
        for name in ["mine/notes.txt", "mine/samples"]:
            self.write(name, b"mine")
            self.fails(7, "holds other things", "choose another", "run", "s.toml", "--results", "mine")
            os.remove(self.path(name))
        os.makedirs(self.path("mine/samples/one"))
        self.fails(7, "holds other things", "choose another", "run", "s.toml", "--results", "mine")

    def test_a_full_disk_locks_nothing(self):
        def small():
            resource.setrlimit(resource.RLIMIT_FSIZE, (16, 16))
        failed = self.run_lamella("run", "s.toml", "--results", "r", preexec_fn=small)
        self.assertEqual(failed.code, 7, failed.err)
        self.works("run", "s.toml", "--results", "r")

    def test_two_runs_on_one_new_folder(self):
        self.write("s.toml", SCENE.replace(b"[diffusion]", b'seed = "1..6"\n[diffusion]').replace(b"honeycomb", b"softwood"))
        runs = [self.popen("run", "s.toml", "--results", "r") for _ in range(3)]
        for run in runs:
            err = run.communicate(timeout=100)[1]
            self.assertEqual(run.returncode, 0, err)
        self.assertEqual(len(os.listdir(self.path("r/samples"))), 6)
        self.assertEqual(glob.glob(self.path("r/**/.lamella-*"), recursive=True), [])


class Memory(Case):
    def limited(self, kilobytes, *words, seconds=60):
        """A run that may map so much, and use so much processor time."""
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (kilobytes * 1024, kilobytes * 1024))
            resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
        return self.run_lamella(*words, preexec_fn=limit, environment={"OMP_NUM_THREADS": "2", "OPENBLAS_NUM_THREADS": "1"})

    def test_a_limit_of_address_space_counts_as_memory(self):
        self.works("generate", "honeycomb", "--size", "400,400", "-o", "h.png")
        # OpenBLAS, which is Debian 13's BLAS, asks for memory as it is loaded, and again without end where there is none
        starts = next(k for k in range(420000, 2000000, 40000) if self.limited(k, "--version", seconds=2).code == 0)
        wall = ["--young", "wall=1e9"]
        for words in [["bond-stiffness", "h.png", *wall], ["snapshot", "h.png", "-o", "x.png", "--overwrite"],
                      ["transient", "h.png", "--diffusivity", "wall=1e-9", "--diffusivity", "lumen=1e-9", "--end-time", "0.001"]]:
            for more in [5000, 40000, 100000]:
                result = self.limited(starts + more, *words)
                self.assertIn(result.code, (0, 5), (words, more, result.code, result.err))
                if result.code == 5:
                    lines = [line.split(" ")[0] for line in result.err.splitlines() if not line.startswith("warning: ")]
                    self.assertEqual(lines, ["error:", "hint:"], result.err)
                    self.assertNotIn("std::", result.err)

    def test_one_far_grain(self):
        near = [(x, z) for x in range(0, 20, 2) for z in range(0, 20, 2)]
        for far in [(1e6, 1), (3, 2e7), (-5e5, -5e5)]:
            rows = "x,z,r\n" + "".join("%g,%g,0.99\n" % grain for grain in [*near, far])
            self.write("g.csv", rows.encode())
            for words in [["bridges", "g.csv"], ["bridges", "g.csv", "--saturation", "40%"], ["packing", "--read", "g.csv"]]:
                self.fails(3, "grain 101 lies", "in the unit of the others", *words)


class Signals(Case):
    def test_what_cannot_be_asked_to_stop_is_ended(self):
        """hypre sets up for seconds: the program ends within 2 s of its own processor time, with a line, and leaves nothing."""
        self.works("generate", "spheres", "--size", "80,80,80", "-o", "s.vti")
        words = ["diffusion", "s.vti", "--conductivity", "matrix=1", "--conductivity", "inclusion=0.1", "--lattice", "d3q19", "--method",
                 "algebraic-multigrid", "-o", "k.vti"]
        for number, moment in [(signal.SIGTERM, 0.4), (signal.SIGINT, 1.5)]:
            process = self.popen(*words)
            used = 0
            while used < moment:
                time.sleep(0.01)
                with open("/proc/%d/stat" % process.pid, encoding="utf-8", errors="replace") as file:
                    fields = file.read().rsplit(")", 1)[1].split()
                used = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
            process.send_signal(number)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            err = process.communicate()[1].decode()
            self.assertEqual(process.returncode, 128 + number, err)
            self.assertLess(usage.ru_utime + usage.ru_stime - used, 2, err)  # 1.5 s, and what the clock's ticks hide
            self.assertRegex(err, r"^error: interrupted.*\nhint: .*\n$")
            self.assertEqual(sorted(os.listdir(self.folder)), ["s.vti"])


class Checkpoints(Case):
    """A checkpoint that was altered, and its hash mended."""

    def test_numbers_that_are_none(self):
        self.works("generate", "honeycomb", "--size", "64,64", "-o", "h.png")
        run = ["transient", "h.png", "--diffusivity", "wall=1e-9", "--diffusivity", "lumen=2e-9", "--end-time", "0.002"]
        self.works(*run, "--checkpoint", "c.h5")
        with open(self.path("c.h5"), "rb") as file:
            whole = file.read()
        content = whole[512:]
        bad = 0
        for at in range(0, len(content), max(1, len(content) // 15)):
            mended = bytearray(content)
            mended[at:at + 8] = struct.pack("<Q", 0xFFF8DEADBEEF0000 + at)
            head = b"Lamella checkpoint\nformat 1\nwritten-by test\nbytes %d\nsha256 %s\nHDF5 from byte 512\n" % (
                len(mended), hashlib.sha256(mended).hexdigest().encode())
            self.write("d.h5", head.ljust(512, b"\0") + bytes(mended))
            for words in [["info", "d.h5"], [*run, "--continue", "d.h5"]]:
                result = self.run_lamella(*words)
                self.assertIn(result.code, (0, 3), (at, words, result.code, result.err))
                bad += result.code == 3
        self.assertGreater(bad, 0)


if __name__ == "__main__":
    unittest.main()
