"""lamella fracture: killed and gone on to the same bonds, checkpoints that cannot be used, a full disk, Ctrl-C."""

import glob
import os
import random
import re
import resource
import signal
import subprocess
import time
import unittest

import pictures
from program import MPIEXEC, PROGRAM, Case

WORDS = ["fracture", "strip.png", "--phase", "255=stone", "--phase", "100=glue", "--young", "stone=2e9", "--young",
         "glue=1e9", "--like", "glue-stone=glue", "--critical-stretch", "stone=0.01", "--critical-stretch", "glue=0.002"]
EVERY = ["--checkpoint-every", "15"]


class Checkpoints(Case):
    def setUp(self):
        super().setUp()
        # a layer of glue across, slightly inclined: some 300 bonds break, in half a second
        rows = [[100 if abs(y - 40 - x // 10) < 3 else 255 for x in range(60)] for y in range(88)]
        self.write("strip.png", pictures.png(rows, pixels_per_metre=100000))

    def arrays(self, name):
        """Points, point data and cells of a .vtp to the last bit, as they are stored; field data has times."""
        with open(self.path(name), encoding="utf-8") as file:
            piece = re.search("<Piece.*</Piece>", file.read(), re.DOTALL).group()
        return re.findall(r'<DataArray[^>]* Name="(\w*)"[^>]*>([^<]*)', piece)

    def curve(self, name):
        with open(self.path(name), encoding="utf-8") as file:
            return file.read()

    def test_killed_and_continued(self):
        whole = self.works(*WORDS, *EVERY, "--broken", "whole.vtp", "--curve", "whole.csv", "--json").json()
        self.assertEqual((whole["continued_at"], whole["checkpoints"], whole["last_checkpoint"]), (0, 0, 0))
        self.assertGreater(whole["statistics"]["events"], 100)
        start = time.monotonic()
        self.works(*WORDS, *EVERY, "--checkpoint", "run.h5", "--quiet")
        seconds = time.monotonic() - start
        os.remove(self.path("run.h5"))
        expected = self.arrays("whole.vtp")
        self.assertLessEqual({"Points", "event", "strain", "critical_strain", "stress", "bond", "phases", "between_grains"},
                             {name for name, _ in expected})
        chance = random.Random(7)
        for attempt in range(3):
            with self.subTest(attempt), self.popen(*WORDS, *EVERY, "--checkpoint", "run.h5", "--continue", "run.h5") as run:
                while not os.path.exists(self.path("run.h5")) and run.poll() is None:
                    time.sleep(0.002)
                time.sleep(chance.random() * 0.7 * seconds)
                run.kill()
                run.communicate()
                result = self.run_lamella(*WORDS, *EVERY, "--checkpoint", "run.h5", "--continue", "run.h5", "--broken",
                                          "again.vtp", "--curve", "again.csv", "--overwrite", "--json")
                self.assertEqual((result.code, result.err), (0, ""))
                found = result.json()
                self.assertGreater(found["continued_at"], 0)
                self.assertEqual(self.arrays("again.vtp"), expected)
                self.assertEqual(self.curve("again.csv"), self.curve("whole.csv"))
                for key in ("peak_stress", "broken_energy", "broken_by_pair", "end", "states"):
                    self.assertEqual(found[key], whole[key])
                os.remove(self.path("run.h5"))

    def test_further(self):
        """Where to end is no part of the scene; states before the checkpoint are not made, their files stay."""
        states = ["--at-broken", "20,60,100", "-o", "s.vti"]
        first = self.run_lamella(*WORDS, *EVERY, *states, "--max-broken", "70", "--checkpoint", "run.h5", "--quiet")
        self.assertEqual(first.code, 0)
        self.assertTrue(os.path.exists(self.path("s_002.vti")))
        before = os.stat(self.path("s_000.vti")).st_mtime_ns
        result = self.run_lamella(*WORDS, *EVERY, *states, "--overwrite", "--continue", "run.h5", "--json")
        self.assertIn("warning: 1 of the states asked for lie before the checkpoint, which stands after 60 events", result.err)
        found = result.json()
        self.assertEqual(found["continued_at"], 60)
        again = self.works(*WORDS, *EVERY, *states[:2], "-o", "t.vti", "--json").json()
        self.assertEqual(found["peak_stress"], again["peak_stress"])
        self.assertEqual(found["broken"], again["broken"])
        self.assertEqual(os.stat(self.path("s_000.vti")).st_mtime_ns, before)
        # 60 lies where the checkpoint stands
        self.assertEqual([(s["broken"], s["file"]) for s in found["states"]],
                         [(60, "s_001.vti"), (100, "s_002.vti"), (again["broken"], "s_003.vti")])
        # ended already
        ended = self.run_lamella(*WORDS, *EVERY, "--max-broken", "30", "--continue", "run.h5", "--json")
        self.assertEqual(ended.code, 0)
        self.assertIn("warning: the run had ended where the checkpoint stands, after 60 events", ended.err)
        self.assertEqual((ended.json()["broken"], ended.json()["end"]), (60, "maximum-broken"))

    def times(self, name):
        with open(self.path(name), encoding="utf-8") as file:
            return re.findall(r'timestep="(.*?)".*file="(.*?)"', file.read())

    def test_states_of_a_run_that_is_killed(self):
        """They are in their files as they come, and the list of them is whole when the run has gone on."""
        states = ["--at-broken", "20,100,200", "-o", "s.vti", "--checkpoint", "run.h5", "--overwrite"]
        with self.popen(*WORDS, *EVERY, *states) as run:
            while not os.path.exists(self.path("s_001.vti")) and run.poll() is None:
                time.sleep(0.002)
            run.kill()
        self.assertEqual([file for _, file in self.times("s.pvd")][:1], ["s_000.vti"])
        before = os.stat(self.path("s_000.vti")).st_mtime_ns
        result = self.run_lamella(*WORDS, *EVERY, *states, "--continue", "run.h5", "--json")
        self.assertEqual(result.code, 0)
        self.assertGreater(result.json()["states_before"], 0)
        self.assertEqual(os.stat(self.path("s_000.vti")).st_mtime_ns, before)
        self.works(*WORDS, *EVERY, *states[:2], "-o", "t.vti")
        self.assertEqual(self.times("s.pvd"), [(at, file.replace("t_", "s_")) for at, file in self.times("t.pvd")])
        self.assertEqual(glob.glob(self.path("*.part*")), [])

    def test_begins_where_there_is_none_yet(self):
        both = ["--checkpoint", "run.h5", "--continue", "./run.h5"]
        result = self.run_lamella(*WORDS, *EVERY, *both, "--max-broken", "20", "--json")
        self.assertEqual(result.code, 0)
        self.assertEqual(result.err, "warning: there was no checkpoint './run.h5' yet: the run began with the unbroken sample\n")
        self.assertEqual((result.json()["continued_at"], result.json()["last_checkpoint"]), (0, 15))
        text = self.works(*WORDS, *EVERY, *both, "--max-broken", "40").out
        self.assertIn("continued after 15 events", text)
        self.assertIn("the last after 30 events", text)

    def long_run(self):
        """Words of a run that takes long enough to be interrupted, with a checkpoint soon."""
        rows = [[100 if abs(y - 150 - x // 10) < 3 else 255 for x in range(200)] for y in range(300)]
        self.write("big.png", pictures.png(rows))
        words = [*WORDS, "--method", "accurate", "--checkpoint-every", "2", "--checkpoint", "a run.h5", "-o", "s.vti"]
        words[1] = "big.png"
        return words

    def test_interrupted_on_two_ranks(self):
        # every rank is told, as by a terminal: mpirun's own way to pass a signal on differs from one to the next
        words = [*MPIEXEC, "2", "sh", "-c", 'touch $$.pid; exec "$0" "$@"', PROGRAM, *self.long_run()]
        with subprocess.Popen(words, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as run:
            while not os.path.exists(self.path("a run.h5")) and run.poll() is None:
                time.sleep(0.02)
            for name in glob.glob(self.path("*.pid")):
                os.kill(int(os.path.basename(name)[:-4]), signal.SIGINT)
            _, err = run.communicate(timeout=60)
        self.assertRegex(err.decode(), r"error: interrupted at [^\n]+\nhint: the checkpoint 'a run.h5' stands after \d+ events; "
                         r"go on from it with: mpirun -n 2 lamella fracture big.png .* --continue 'a run.h5'\n")

    def test_interrupted(self):
        words = self.long_run()
        with self.popen(*words) as run:
            while not os.path.exists(self.path("a run.h5")) and run.poll() is None:
                time.sleep(0.02)
            run.send_signal(signal.SIGINT)
            out, err = run.communicate(timeout=60)
        self.assertEqual((run.returncode, out), (130, b""))
        self.assertRegex(err.decode(), r"error: interrupted at [^\n]+\nhint: the checkpoint 'a run.h5' stands after \d+ events; "
                         r"go on from it with: lamella fracture big.png .* --continue 'a run.h5'\n")
        self.assertEqual(sorted(os.listdir(self.folder)), ["a run.h5", "big.png", "strip.png"])
        words[words.index("2")] = "100000"
        words[words.index("a run.h5")] = "b.h5"
        with self.popen(*words) as run:
            time.sleep(2)
            run.send_signal(signal.SIGTERM)
            _, err = run.communicate(timeout=60)
        self.assertEqual(run.returncode, 143)
        self.assertIn("hint: no checkpoint was written yet: the first comes after 100000 events", err.decode())

    def test_full_disk(self):
        # a limit on the size of a file stands for it: what is written beyond fails alike
        def small():
            resource.setrlimit(resource.RLIMIT_FSIZE, (20000, resource.RLIM_INFINITY))

        result = self.run_lamella(*WORDS, *EVERY, "--max-broken", "40", "--checkpoint", "run.h5", "--json", preexec_fn=small)
        self.assertEqual(result.code, 0, result.err)
        self.assertRegex(result.err, r"^warning: 2 of the checkpoints could not be written: cannot write 'run.h5': File too large; "
                         r"the last good checkpoint stays, the run goes on .*\n$")
        self.assertEqual(result.json()["broken"], 40)
        self.assertEqual(sorted(os.listdir(self.folder)), ["strip.png"])

    def test_what_cannot_be_continued(self):
        good = [*WORDS, *EVERY, "--max-broken", "40"]
        go = ["--continue", "run.h5"]
        self.works(*good, "--checkpoint", "run.h5", "--quiet")
        with open(self.path("run.h5"), "rb") as file:
            data = file.read()
        self.fails(3, "cannot read 'none.h5': No such file", "", *good, "--continue", "none.h5")
        self.fails(3, "cannot read 'none.h5': No such file", "", *good, "--continue", "none.h5", "--checkpoint", "b.h5")
        self.fails(3, "'strip.png' is not a checkpoint", "as its checkpoint", *good, "--continue", "strip.png")
        self.write("other.h5", b"\x89HDF\r\n\x1a\n" + bytes(1000))
        self.fails(3, "'other.h5' is not a checkpoint, but another HDF5 file", "", *good, "--continue", "other.h5")
        for size in (10, 400, 2000, len(data) - 1):
            self.write("cut.h5", data[:size])
            self.fails(3, "'cut.h5' is cut off", "start the run anew", *good, "--continue", "cut.h5")
        self.write("bad.h5", data[:-100] + bytes([data[-100] ^ 1]) + data[-99:])
        self.fails(3, "'bad.h5' is damaged", "start the run anew", *good, "--continue", "bad.h5")
        self.write("new.h5", data.replace(b"\nformat 1\n", b"\nformat 7\n", 1))
        self.fails(3, "'new.h5' is newer than this program: its format is 7", "the program that wrote it", *good,
                   "--continue", "new.h5")
        self.write("empty.h5", b"")
        self.fails(3, "'empty.h5' is empty", "", *good, "--continue", "empty.h5")
        os.mkdir(self.path("folder.h5"))
        self.fails(3, "'folder.h5' is a folder", "", *good, "--continue", "folder.h5")
        self.fails(3, "'folder.h5' is a folder", "", *good, "--checkpoint", "folder.h5")
        self.fails(3, "there is no folder 'nowhere'", "make it first", *good, "--checkpoint", "nowhere/run.h5")
        other = "'run.h5' is a checkpoint of another scene: "
        self.fails(3, other + "events between renewals: 15 there, 500 here", "of the run that wrote it", *WORDS, *go)
        self.fails(3, other + "load: stretch there, shear here", "", *good, *go, "--load", "shear")
        self.fails(3, other + "rivals within: 0.005 there, 0 here", "", *good, *go, "--no-rivals")
        self.fails(3, other + "horizon: 3 spacings there, 2 spacings here", "", *good, *go, "--horizon", "2")
        self.fails(3, other, "", *good, *go, "--notch", "0,205um,100um,205um")
        self.fails(2, "--checkpoint 'run.vti': checkpoints are written as HDF5", ".h5", *good, "--checkpoint", "run.vti")
        self.fails(2, "--checkpoint-every '0' is neither a whole number above 0 nor a time", "500,10min", *WORDS, "--checkpoint-every", "0")
        self.fails(7, "'run.h5' exists already", "--continue run.h5 to go on from it", *good, "--checkpoint", "run.h5")


if __name__ == "__main__":
    unittest.main()
