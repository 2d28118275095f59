"""What the numbers on the command line mean."""

import array
import math
import pathlib
import re
import unittest

import grids
import pictures
from program import CONDUCTIVITIES, PHASES, Case


class Answers(Case):
    def solve(self, *words, **options):
        return self.works("diffusion", *words, "--json", **options).json()

    def test_layers_are_exact_in_both_directions(self):
        # Across the flux the harmonic mean, along it the arithmetic one, at any resolution.
        self.write("p.png", pictures.png(pictures.stripes(40, 30, bands=4)))
        answer = self.solve("p.png", *PHASES, *CONDUCTIVITIES)
        self.assertAlmostEqual(answer["effective"]["x"], 2 / (1 / 0.1 + 1), delta=1e-8)
        self.assertAlmostEqual(answer["effective"]["y"], 0.55, delta=1e-8)
        self.assertAlmostEqual(answer["bounds"]["series"], 2 / 11, delta=1e-12)
        self.assertAlmostEqual(answer["bounds"]["parallel"], 0.55, delta=1e-12)
        self.assertLess(answer["lattice_error"], 1e-7)
        # Whether the layers end where their pixels do the picture does not tell: a bar, but no longer than a pixel.
        self.assertLess(answer["estimated_error"], 0.1)
        self.assertEqual(answer["size"], [40, 30])
        self.assertEqual([phase["name"] for phase in answer["phases"]], ["lumen", "wall"])
        self.assertEqual([phase["fraction"] for phase in answer["phases"]], [0.5, 0.5])

    def test_an_empty_box_has_one(self):
        self.write("p.png", pictures.png([[255] * 17] * 11))
        for lattice in ["d2q5", "d2q9"]:
            answer = self.solve("p.png", "--phase", "255=wall", "--conductivity", "wall=1", "--lattice", lattice)
            self.assertAlmostEqual(answer["effective"]["x"], 1, delta=1e-8)
            self.assertAlmostEqual(answer["effective"]["y"], 1, delta=1e-8)

    def test_factors_of_one_conducting_phase(self):
        self.works("generate", "laminate", "--size", "12,10,8", "--axis", "y", "--cells", "2", "--solid-fraction", "0.4", "-o", "l.vti")
        answer = self.solve("l.vti", "--conductivity", "matrix=3,inclusion=0", "--direction", "x", "--no-error-estimate")
        self.assertEqual(answer["conducting_phase"], "matrix")
        share = next(phase["fraction"] for phase in answer["phases"] if phase["name"] == "matrix")
        self.assertAlmostEqual(answer["relative"]["x"], share, delta=1e-8)  # straight channels
        self.assertAlmostEqual(answer["formation_factor"]["x"], 1 / share, delta=1e-7)
        self.assertAlmostEqual(answer["tortuosity_factor"]["x"], 1, delta=1e-7)
        both = self.solve("l.vti", "--conductivity", "matrix=3,inclusion=1", "--direction", "y", "--no-error-estimate")
        self.assertIsNone(both["conducting_phase"])
        self.assertEqual((both["relative"], both["formation_factor"]), ({"y": None}, {"y": None}))
        self.assertAlmostEqual(both["tortuosity_factor"]["y"], both["bounds"]["parallel"] / both["bounds"]["series"], delta=1e-7)

    def test_greys_as_shares_of_two_phases(self):
        # A layer from 3.25 to 9.5 of 16 voxels along x, in 12 bits of a grey scale from 40 to 240.
        row = [40 + 200 * max(0, min(9.5, x + 1) - max(3.25, x)) for x in range(16)]
        self.write("layer_16x8x8_u8.raw", bytes(round(g) for g in row) * 64)
        words = ["layer_16x8x8_u8.raw", "--shares", "40,240", "--conductivity", "low=1,high=20"]
        part = 6.25 / 16
        answer = self.solve(*words, "--direction", "all", "--no-error-estimate")
        self.assertAlmostEqual(answer["effective"]["x"] * (part / 20 + 1 - part), 1, delta=1e-2)  # the layer leads past it: in parallel
        self.assertAlmostEqual(answer["effective"]["y"], 20 * part + 1 - part, delta=1e-5)
        self.assertEqual([phase["name"] for phase in answer["phases"]], ["low", "high"])
        self.assertAlmostEqual(answer["phases"][1]["fraction"], part, delta=1e-9)
        self.assertAlmostEqual(answer["bounds"]["parallel"], 20 * part + 1 - part, delta=1e-9)
        # a bar, and what is expected, from voxels of twice the size
        answer = self.solve(*words, "--direction", "y")
        self.assertLess(answer["estimated_error"], 1e-3)
        self.assertEqual(answer["estimated_error"], answer["lattice_error"])
        for wrong, text in [
            ([*words[:3], "--conductivity", "low=1,matrix=2"], "a conductivity of 'matrix' where greys are shares"),
            ([*words[:3], "--conductivity", "low=1"], "no conductivity of 'high'"),
            ([*words[:2], "250,255", *words[3:]], "no node crosses from 250 to 255: none is more high than low"),
            ([*words[:2], "1e300,-1e300", *words[3:]], "no node crosses from 1e+300 to -1e+300"),
            ([*words[:2], "40,40", *words[3:]], "greys of none and of all that are both 40"),
            ([*words, "--refine", "2"], "greys as shares of two phases, with pixels that are split"),
        ]:
            refused = self.run_lamella("diffusion", *wrong)
            self.assertIn(refused.code, (2, 3))
            self.assertIn(text, refused.err)

    def test_labels_are_smoothed(self):
        n, radius = 24, 7.3
        ball = lambda x, y, z: math.dist((x, y, z), (11.6, 11.2, 11.9)) < radius  # noqa: E731
        self.write("ball_24x24x24_u8.raw", bytes(ball(x, y, z) for z in range(n) for y in range(n) for x in range(n)))
        words = ["ball_24x24x24_u8.raw", "--phase", "0=matrix", "--phase", "1=ball", "--conductivity", "matrix=1,ball=10", "--direction", "z", "--sides", "mixed"]
        plain = self.solve(*words)
        smooth = self.solve(*words, "--smooth-labels")
        # Maxwell's for a fraction of 0.118, to which other spheres add 0.1 %
        fraction = 4 / 3 * math.pi * radius**3 / n**3
        exact = (1 + 2 * fraction * 0.75) / (1 - fraction * 0.75)
        self.assertAlmostEqual(smooth["extrapolated"]["z"] / exact, 1, delta=4e-3)
        self.assertLess(abs(smooth["effective"]["z"] / exact - 1), smooth["estimated_error"])
        self.assertAlmostEqual(smooth["phases"][1]["fraction"] / plain["phases"][1]["fraction"], 1, delta=5e-3)
        self.assertEqual([phase["name"] for phase in smooth["phases"]], ["matrix", "ball"])
        many = self.run_lamella("diffusion", *words, "--smooth-labels", "--json", "--threads", "2", ranks=2).json()
        self.assertAlmostEqual(many["effective"]["z"] / smooth["effective"]["z"], 1, delta=1e-7)
        self.assertAlmostEqual(many["estimated_error"] / smooth["estimated_error"], 1, delta=1e-4)
        for more, text in [
            (["--refine", "2"], "smoothed labels, with pixels that are split"),
            (["--shares", "0,1"], "smoothed labels of an image that is grey"),
        ]:
            refused = self.run_lamella("diffusion", *words, "--smooth-labels", *more)
            self.assertEqual(refused.code, 2, refused.err)
            self.assertIn(text, refused.err)

    def test_every_documented_key_is_there(self):
        self.works("generate", "softwood", "--size", "60,50", "-o", "t.png")
        answer = self.solve("t.png", *CONDUCTIVITIES, "--threads", "2")
        for key in [
            "effective", "extrapolated", "conducting_phase", "relative", "formation_factor", "tortuosity_factor", "estimated_error", "estimated_errors", "lattice_error", "lattice_errors",
            "picture_error", "picture_errors", "target_error", "target", "tensor", "bounds", "iterations",
            "seconds", "setup_seconds", "solve_seconds", "peak_memory_bytes", "method", "directions", "phases", "file",
            "size", "window", "pixel_size", "pixel_size_source", "refine", "lattice", "sides", "length", "tolerance",
            "balance", "solver_error", "nodes", "stored", "skipped", "solver_bytes", "threads", "ranks", "files", "version", "commit",
            "provenance",
        ]:
            self.assertIn(key, answer)
        self.assertEqual(answer["pixel_size"], 1e-6)
        self.assertEqual(answer["threads"], 2)
        self.assertEqual(answer["refine"], 1)
        self.assertLess(answer["balance"], answer["tolerance"])
        self.assertLess(answer["solver_error"], answer["tolerance"])
        self.assertGreater(answer["peak_memory_bytes"], 1 << 20)
        self.assertEqual(answer["nodes"], 3000)
        for axis in "xy":
            direction = answer["directions"][axis]
            self.assertAlmostEqual(direction["inlet"], answer["effective"][axis], delta=1e-8)
            self.assertAlmostEqual(direction["outlet"], answer["effective"][axis], delta=1e-8)
            self.assertLess(answer["bounds"]["series"], answer["effective"][axis])
            self.assertGreater(answer["bounds"]["parallel"], answer["effective"][axis])

    def test_periodic_sides_give_the_tensor(self):
        # Slanted layers: off the axes the tensor has entries, and it is symmetric.
        rows = [[255 if ((x + y) // 5) % 2 else 0 for x in range(40)] for y in range(40)]
        self.write("p.png", pictures.png(rows))
        answer = self.solve("p.png", *PHASES, *CONDUCTIVITIES, "--sides", "periodic", "--refine", "2")
        (xx, xy), (yx, yy) = answer["tensor"]
        self.assertAlmostEqual(xy, yx, delta=1e-6)
        self.assertAlmostEqual(xx, yy, delta=1e-6)
        # In the picture the layers rise to the right, x + y constant downwards: in axes with y up xy is positive.
        self.assertGreater(xy, 0.05)
        self.assertGreater(xx + xy, xx - xy)

    def test_keller(self):
        # k(k1, k2) along x times k(k2, k1) along y is k1 k2, for any periodic picture (Keller 1964). On a lattice with
        # harmonic faces it holds to the lattice's error; twice as fine, the product is nearer.
        self.works("generate", "disks", "--size", "48,48", "--solid-fraction", "0.4", "-o", "d.png")
        errors = []
        for refine in ["1", "2"]:
            product = 1
            for axis, first, second in [("x", 1, 5), ("y", 5, 1)]:
                answer = self.solve("d.png", "--conductivity", "matrix=%d" % first, "--conductivity", "inclusion=%d" % second,
                                    "--sides", "periodic", "--direction", axis, "--refine", refine, "--no-error-estimate")
                product *= answer["effective"][axis]
            errors.append(abs(product / 5 - 1))
        self.assertLess(errors[0], 0.03)
        self.assertLess(errors[1], errors[0])

    def test_directions_are_those_of_the_picture(self):
        # One wall across the picture's upper edge only: y from the top meets it first.
        rows = [[255] * 20 if y < 5 else [0] * 20 for y in range(20)]
        self.write("p.png", pictures.png(rows))
        self.works("diffusion", "p.png", *PHASES, "--conductivity", "lumen=1", "--conductivity", "wall=0.01",
                   "--direction", "y", "-o", "h.vti")
        info = self.info("h.vti")
        arrays = {array["name"]: array for array in info["point_arrays"]}
        # Downwards in a picture is against VTK's y: the flux is negative there.
        self.assertLess(arrays["flux"]["range"][1][1], 0)
        # The wall at the top takes nearly all of the drop from 1, so that the largest value is at the inlet.
        self.assertGreater(arrays["temperature"]["range"][0][1], 0.9)
        self.assertEqual(info["size"], [20, 20])

    def test_fields_of_volumes_are_written_by_slabs(self):
        # Layers across the flux: the same flux everywhere, and values between 0 and 1; whatever the file and the ranks.
        self.works("generate", "laminate", "--size", "64,60,72", "--pixel-size", "1m", "--axis", "z", "--cells", "2",
                   "--solid-fraction", "0.5", "-o", "l.vti")
        words = ["l.vti", "--conductivity", "matrix=1,inclusion=0.25", "--direction", "z"]
        expected = 1 / (0.5 + 0.5 / 0.25) / 72
        seen = []
        for name, ranks in [("a.vti", 0), ("b.vti", 2), ("c.vtkhdf", 0)]:
            answer = self.works("diffusion", *words, "-o", name, "--json", ranks=ranks).json()
            self.assertIsNotNone(answer["estimated_error"])
            if name.endswith("hdf"):
                self.works("convert", name, "-o", "c.vti")
                name = "c.vti"
            info = self.info(name)
            self.assertEqual(info["size"], [64, 60, 72])
            arrays = {array["name"]: array for array in info["point_arrays"]}
            self.assertEqual(set(arrays), {"phase", "temperature", "flux"})
            for end in arrays["flux"]["range"][2]:
                self.assertAlmostEqual(end, expected, delta=1e-6 * expected)
            low, high = arrays["temperature"]["range"][0]
            self.assertAlmostEqual(high, 1 - expected / 2, delta=1e-6)
            self.assertAlmostEqual(low, expected / 2 / 0.25, delta=1e-6)
            seen.append(info["field_data"])
        self.assertEqual({key for key in seen[0]}, {key for key in seen[1]})
        self.assertTrue({"effective_conductivity", "estimated_error", "provenance"} <= set(seen[0]) | {"provenance"})
        self.fails(2, "written as .vti or .vtkhdf", "end the name in", "diffusion", *words, "-o", "f.png")

    def test_the_window_counts_from_the_top(self):
        rows = [[255] * 20 if y < 5 else [0] * 20 for y in range(20)]
        self.write("p.png", pictures.png(rows))
        top = self.solve("p.png", *PHASES, *CONDUCTIVITIES, "--window", "0,0,20,5")
        self.assertEqual([phase["fraction"] for phase in top["phases"]], [0.0, 1.0])
        self.assertEqual(top["window"], [0, 0, 20, 5])

    def test_refinement_splits_pixels(self):
        self.works("generate", "softwood", "--size", "60,50", "-o", "t.png")
        coarse = self.solve("t.png", *CONDUCTIVITIES, "--direction", "x")
        fine = self.solve("t.png", *CONDUCTIVITIES, "--direction", "x", "--refine", "2")
        self.assertEqual(fine["nodes"], 4 * coarse["nodes"])
        self.assertEqual(fine["refine"], 2)
        self.assertEqual(fine["phases"], coarse["phases"])
        # The lattice's part of the coarse one used that very solve: error of order 1 means twice the change.
        change = abs(fine["effective"]["x"] - coarse["effective"]["x"]) / coarse["effective"]["x"]
        self.assertAlmostEqual(coarse["lattice_error"], 2 * change, delta=1e-6)
        self.assertLess(fine["lattice_error"], coarse["lattice_error"])
        # and the picture's own part is not changed by splitting its pixels
        self.assertLess(abs(fine["picture_error"] / coarse["picture_error"] - 1), 0.2)
        every = {step["every_pixel"]: step for step in coarse["directions"]["x"]["steps"] if step["every_pixel"] > 1}
        self.assertEqual([every[stride]["pictures"] for stride in (2, 3, 4)], [4, 9, 8])
        self.assertEqual(every[2]["nodes"], coarse["nodes"])

    def test_a_target_for_the_error(self):
        self.works("generate", "softwood", "--size", "60,50", "-o", "t.png")
        plain = self.solve("t.png", *CONDUCTIVITIES)
        within = (plain["estimated_error"] + plain["picture_error"]) / 2  # halfway to what splitting pixels can reach
        run = self.run_lamella("diffusion", "t.png", *CONDUCTIVITIES, "--target-error", str(within), "-o", "h.vti", "--json")
        self.assertEqual(run.code, 0, run.err)
        answer = run.json()
        self.assertEqual(answer["target"], "reached")
        self.assertEqual(answer["target_error"], within)
        self.assertLessEqual(answer["estimated_error"], within)
        self.assertGreater(answer["refine"], 1)
        self.assertIn("note: this error needs refinement", run.err, "said beforehand")
        for axis in "xy":
            steps = answer["directions"][axis]["steps"]
            self.assertEqual(steps[-1]["refine"], answer["refine"])
            self.assertTrue(all(step["seconds"] > 0 for step in steps), "what each cost")
        self.assertEqual(self.info("h_x.vti")["size"], [60 * answer["refine"], 50 * answer["refine"]])
        table = self.run_lamella("diffusion", "t.png", *CONDUCTIVITIES, "--target-error", str(within)).out
        self.assertIn("what an error below", table)
        self.assertIn("every second pixel, 4 pictures", table)
        self.assertIn(" s in all", table)

    def test_a_target_that_only_a_finer_picture_reaches(self):
        self.works("generate", "softwood", "--size", "60,50", "-o", "t.png")
        result = self.run_lamella("diffusion", "t.png", *CONDUCTIVITIES, "--target-error", "0.1%", "--json", "-o", "h.vti")
        self.assertEqual(result.code, 8)
        self.assertIn("error: an error below 0.1 % was asked for, and ", result.err)
        self.assertIn("of it is the picture's own", result.err)
        self.assertIn("hint: only a picture with smaller pixels", result.err)
        self.assertIn("lamella micrograph", result.err)
        answer = result.json()  # what was found is printed and written all the same
        self.assertEqual(answer["target"], "picture too coarse")
        self.assertGreater(answer["picture_error"], 0.001)
        self.assertEqual(self.info("h_x.vti")["size"], [60, 50])

    def test_without_an_estimate_there_is_one_solve(self):
        self.works("generate", "softwood", "--size", "60,50", "-o", "t.png")
        answer = self.solve("t.png", *CONDUCTIVITIES, "--no-error-estimate", "--direction", "x")
        self.assertIsNone(answer["estimated_error"])
        self.assertEqual(len(answer["directions"]["x"]["steps"]), 1)

    def test_the_table(self):
        self.works("generate", "softwood", "--size", "60,50", "-o", "t.png")
        out = self.works("diffusion", "t.png", *CONDUCTIVITIES).out
        for text in ["60 × 50 pixels of 1 µm", "lumen", "wall", "series", "parallel", "Hashin-Shtrikman", "d2q5",
                     "half a spacing outside the outer nodes", "conductivity 1 has 1"]:
            self.assertIn(text, out)

    def test_a_volume(self):
        self.works("generate", "laminate", "--size", "12,10,8", "--axis", "z", "--cells", "2", "-o", "l.vti")
        for name in ["l.vti"]:
            answer = self.solve(name, "--conductivity", "matrix=1", "--conductivity", "inclusion=0.1")
            self.assertAlmostEqual(answer["effective"]["x"], 0.55, delta=1e-7)
            self.assertAlmostEqual(answer["effective"]["y"], 0.55, delta=1e-7)
            self.assertAlmostEqual(answer["effective"]["z"], 2 / 11, delta=1e-7)
            self.assertEqual(answer["lattice"], "d3q7")
            self.assertEqual(len(answer["tensor"]), 3)
        answer = self.solve("l.vti", "--conductivity", "matrix=1", "--conductivity", "inclusion=0.1", "--lattice",
                            "d3q19", "--direction", "z", "--window", "0,0,0,12,10,4")
        self.assertAlmostEqual(answer["effective"]["z"], 2 / 11, delta=1e-7)

    def test_the_same_sample_in_every_format(self):
        values = []
        for name in ["t.png", "t.tif", "t.vti"]:
            self.works("generate", "softwood", "--size", "60,50", "-o", name)
            values.append(self.solve(name, *CONDUCTIVITIES, "--direction", "y")["effective"]["y"])
        self.assertEqual(values[0], values[1])
        self.assertEqual(values[0], values[2])
        values = []
        for name in ["v.raw", "v.tif", "v.vti"]:
            self.works("generate", "softwood", "--size", "32,30,28", "--pixel-size", "2um", "-o", name)
            values.append(self.solve(name, *CONDUCTIVITIES, "--direction", "z", "--no-error-estimate")["effective"]["z"])
        self.assertEqual(values[0], values[1])
        self.assertEqual(values[0], values[2])

    def test_skips_what_is_not_asked_for(self):
        self.works("generate", "softwood", "--size", "60,50", "-o", "t.png")
        self.works("diffusion", "t.png", *CONDUCTIVITIES, "--quantity", "concentration", "--direction", "x", "-o", "h.vti")
        names = [array["name"] for array in self.info("h.vti")["point_arrays"]]
        self.assertEqual(names, ["phase", "concentration", "flux"])


class Walls(Case):
    """NAME=ALONG:ACROSS: walls whose direction the lattice knows."""

    def lattice(self):
        self.works("generate", "softwood", "--size", "120,90", "--seed", "2", "-o", "labels.png")
        self.works("micrograph", "labels.png", "--lamella", "none", "-o", "w.vti")
        return ["w.vti", "--conductivity", "lumen=0.023"]

    def test_directions_matter_as_they_should(self):
        words = self.lattice()

        def solve(wall, *more):
            answer = self.works("diffusion", *words, "--conductivity", "wall=" + wall, "--json", *more).json()
            return answer, answer["effective"]

        _, plain = solve("1")
        _, same = solve("1:1")
        answer, along = solve("1.2:0.8")
        _, across = solve("0.8:1.2")
        self.assertEqual(same, plain)  # the very same solve
        for axis in "xy":  # heat runs along the walls
            self.assertGreater(along[axis], 1.05 * plain[axis])
            self.assertLess(across[axis], 0.95 * plain[axis])
            self.assertLess(along[axis], 1.2 * plain[axis])  # no more than if all of the wall had the larger one
        self.assertEqual(answer["lattice"], "d2q9")
        wall = answer["phases"][1]
        self.assertEqual((wall["conductivity"], wall["conductivity_across"]), (1.2, 0.8))
        # bounds: series with the smaller one, parallel with the larger one
        share = wall["fraction"]
        self.assertAlmostEqual(answer["bounds"]["parallel"], share * 1.2 + (1 - share) * 0.023, delta=1e-9)
        self.assertAlmostEqual(answer["bounds"]["series"], 1 / (share / 0.8 + (1 - share) / 0.023), delta=1e-9)
        table = self.works("diffusion", *words, "--conductivity", "wall=1.2:0.8", "--no-error-estimate").out
        self.assertIn("1.2 along the walls, 0.8 across", table)
        # a window, a refinement, a file, two ranks
        small, _ = solve("1.2:0.8", "--window", "30,20,60,50", "--refine", "2", "-o", "f.vti", "--direction", "x")
        self.assertEqual(small["nodes"], 120 * 100)
        shared, _ = solve("1.2:0.8", "--window", "30,20,60,50", "--refine", "2", "--direction", "x", "--no-error-estimate")
        self.assertAlmostEqual(shared["effective"]["x"], small["effective"]["x"], delta=1e-9)
        two = self.works("diffusion", *words, "--conductivity", "wall=1.2:0.8", "--json", ranks=2).json()
        self.assertAlmostEqual(two["effective"]["y"], along["y"], delta=1e-8)
        # fluxes of the nodes stand for those of the links
        flux = self.works("flux-map", "f.vti", "-o", "map.vti", "--json").json()
        self.assertAlmostEqual(flux["effective"]["x"], small["effective"]["x"], delta=1e-6)

    def test_a_segmentation_error_that_nothing_tells(self):
        words = self.lattice()[:1]
        given = ["--conductivity", "lumen=0.026,wall=0.41"]
        self.fails(2, "nothing tells how far surfaces may lie", "in pixels", "diffusion", *words, *given, "--segmentation-error")
        answer = self.works("diffusion", *words, *given, "--surface-doubt", "0.3", "--json").json()
        self.assertLess(answer["surface_sensitivity"]["x"]["lumen:wall"], 0)
        # along and across: on elements, on ranks too; one conductivity twice is the one conductivity
        axes = ["diffusion", *words, "--surface-doubt", "0.3", "--no-error-estimate", "--json", "--conductivity"]
        turned = self.works(*axes, "lumen=0.026,wall=0.6:0.3").json()
        self.assertEqual(turned["lattice"], "q1")
        self.assertLess(turned["surface_sensitivity"]["x"]["lumen:wall"], 0)
        self.assertEqual(turned["segmentation_errors"]["x"],
                         0.3 * abs(turned["surface_sensitivity"]["x"]["lumen:wall"]) / turned["effective"]["x"])
        shared = self.works(*axes, "lumen=0.026,wall=0.6:0.3", ranks=2).json()
        self.assertAlmostEqual(shared["surface_sensitivity"]["y"]["lumen:wall"] / turned["surface_sensitivity"]["y"]["lumen:wall"], 1, delta=1e-6)
        same, once = (self.works(*axes, "lumen=0.026,wall=" + wall, "--lattice", "q1").json()["segmentation_errors"] for wall in ("0.41:0.41", "0.41"))
        self.assertEqual(same, once)
        self.fails(2, "a segmentation error of conductivities along and across walls on d2q9", "take q1", "diffusion", *words, "--conductivity",
                   "lumen=0.023,wall=1:0.5", "--surface-doubt", "0.3", "--lattice", "d2q9")

    def test_what_conductivities_leave(self):
        words = self.lattice()[:1]
        given = ["--conductivity", "lumen=0.026", "--conductivity", "wall=0.41±0.02"]
        run = lambda *more: self.works("diffusion", *words, *given, *more, "--json").json()  # noqa: E731
        answer = run("--direction", "x")
        by, value = answer["sensitivity"]["x"], answer["effective"]["x"]
        self.assertAlmostEqual(0.026 * by["lumen"] + 0.41 * by["wall"], value, delta=1e-12)
        self.assertAlmostEqual(answer["input_errors"]["x"], 0.02 * by["wall"] / value, delta=1e-12)
        whole = (answer["input_errors"]["x"] ** 2 + answer["estimated_errors"]["x"] ** 2) ** 0.5
        self.assertAlmostEqual(answer["total_errors"]["x"], whole, delta=1e-12)
        more = self.works("diffusion", *words, "--conductivity", "lumen=0.026,wall=0.4141", "--direction", "x", "--json").json()
        self.assertAlmostEqual(more["effective"]["x"] - value, 0.0041 * by["wall"], delta=0.01 * 0.0041 * by["wall"])
        text = self.works("diffusion", *words, *given).out
        for line in ("1 % more of a conductivity changes the value by", "the conductivities' uncertainty leaves", "in all, of what was asked for", "hal"):
            self.assertIn(line, text)
        plain = self.works("diffusion", *words, "--conductivity", "lumen=0.026,wall=0.41", "--json").json()
        self.assertEqual((plain["sensitivity"], plain["input_errors"], plain["total_errors"]), (None, None, None))
        alone = self.works("diffusion", *words, "--conductivity", "lumen=0.026,wall=0.41+-0.02", "--no-error-estimate", "--json", ranks=2).json()
        self.assertAlmostEqual(alone["input_errors"]["x"], answer["input_errors"]["x"], delta=1e-6)
        self.assertIsNone(alone["total_errors"]["x"])
        both = self.works("diffusion", *words, "--conductivity", "lumen=0.023", "--conductivity", "wall=1.2±0.1:0.8±0.2", "--json").json()
        self.assertEqual(both["lattice"], "q1")
        wall = both["sensitivity"]["x"]
        self.assertAlmostEqual(0.023 * wall["lumen"] + 1.2 * wall["wall"] + 0.8 * wall["wall:across"], both["effective"]["x"], delta=1e-9)
        self.fails(2, "'wide' is not how far", "wall=0.41±0.02", "diffusion", *words, "--conductivity", "lumen=0.026,wall=0.41±wide")

    def test_membranes(self):
        self.works("generate", "laminate", "--size", "40,8", "--pixel-size", "1um", "--cells", "4", "-o", "layers.png")
        words = ["layers.png", "--conductivity", "matrix=2,inclusion=0.5", "--direction", "x"]
        run = lambda *more: self.works("diffusion", *words, *more, "--json").json()  # noqa: E731
        # 4 pairs of layers of 5 pixels between two faces: 7 surfaces
        layers = 4 * 5e-6 * (1 / 2 + 1 / 0.5)
        answer = run("--membrane", "inclusion-matrix=3e-6", "--sensitivity")
        exact = 40e-6 / (layers + 7 * 3e-6)
        self.assertAlmostEqual(answer["effective"]["x"] / exact, 1, delta=1e-8)
        self.assertAlmostEqual(answer["bounds"]["series"] / exact, 1, delta=1e-8)
        self.assertEqual(answer["bounds"]["hashin_shtrikman"][0], answer["bounds"]["series"])
        membrane, = answer["membranes"]
        self.assertEqual((membrane["name"], membrane["resistance"]), ("matrix-inclusion", 3e-6))
        self.assertAlmostEqual(membrane["area"] * 40e-6 / 7, 1, delta=1e-12)
        by = answer["sensitivity"]["x"]
        self.assertAlmostEqual(membrane["sensitivity"]["x"] / (-7 * exact * exact / 40e-6), 1, delta=1e-6)
        self.assertAlmostEqual((2 * by["matrix"] + 0.5 * by["inclusion"] - 3e-6 * membrane["sensitivity"]["x"]) / exact, 1, delta=1e-8)
        self.assertAlmostEqual(run("--permeance", "matrix-inclusion=333333.33333333")["effective"]["x"] / exact, 1, delta=1e-8)
        self.assertAlmostEqual(run("--membrane", "matrix-inclusion=3e-6", "--refine", "2")["effective"]["x"] / exact, 1, delta=1e-8)
        periodic = run("--membrane", "matrix-inclusion=3e-6", "--sides", "periodic", "--window-error")
        self.assertAlmostEqual(periodic["effective"]["x"] / (40e-6 / (layers + 8 * 3e-6)), 1, delta=1e-8)
        two = self.works("diffusion", *words, "--membrane", "matrix-inclusion=3e-6", "--json", ranks=2).json()
        self.assertAlmostEqual(two["effective"]["x"] / exact, 1, delta=1e-8)
        self.assertIsNone(run()["membranes"])
        text = self.works("diffusion", *words, "--membrane", "matrix-inclusion=3e-6", "--sensitivity", "-o", "field.vti").out
        for line in ("membrane          resistance  length over area [1/µm]", "matrix-inclusion  3e-06", "a resistance changes the value by",
                     "membrane matrix-inclusion -"):
            self.assertIn(line, text)
        self.assertIn("membrane", pathlib.Path(self.folder, "field.vti").read_text(errors="replace"))
        # links through membranes are not what the phases alone say
        self.assertAlmostEqual(self.works("flux-map", "field.vti", "--json").json()["effective"]["x"] / exact, 1, delta=1e-8)
        fails = lambda *rest: self.fails(2, *rest[:2], "diffusion", *words, *rest[2:])  # noqa: E731
        good = ["--membrane", "matrix-inclusion=3e-6"]
        fails("'matrix-wall', which are not two phases", "its phases are", "--membrane", "matrix-wall=1e-8")
        fails("between 'matrix' and itself", "two different phases", "--membrane", "matrix-matrix=1e-8")
        fails("resistance of the membrane matrix-inclusion is -1", "at least 0", "--membrane", "matrix-inclusion=-1")
        fails("resistance of the membrane matrix-inclusion is inf", "a very large one", "--membrane", "matrix-inclusion=inf")
        fails("resistance of the membrane matrix-inclusion is nan", "at least 0", "--membrane", "matrix-inclusion=nan")
        fails("permeance of the membrane matrix-inclusion is 0", "above 0", "--permeance", "matrix-inclusion=0")
        fails("'much' is not a number", "--membrane PAIR=VALUE", "--membrane", "matrix-inclusion=much")
        fails("is given twice", "one resistance", *good, "--permeance", "inclusion-matrix=1e8")
        fails("membranes on d2q9", "take d2q5", *good, "--lattice", "d2q9")
        fails("membranes on q1", "take d2q5", *good, "--lattice", "q1")
        fails("a segmentation error where surfaces have membranes", "leave one", *good, "--surface-doubt", "0.3")
        pathlib.Path(self.folder, "bare_8x8x8_u8.raw").write_bytes(bytes([0, 0, 0, 0, 1, 1, 1, 1] * 64))
        bare = ["diffusion", "bare_8x8x8_u8.raw", "--phase", "0=matrix", "--phase", "1=inclusion", *words[1:], *good]
        self.fails(2, "does not say its pixel size", "--pixel-size", *bare)
        # layers along x, of voxels four times as long along z
        flat = [*bare, "--pixel-size", "1um", "--slice-distance", "4um"]
        answer = self.works(*flat, "--json").json()
        self.assertAlmostEqual(answer["effective"]["x"] / (8e-6 / (4e-6 * (1 / 2 + 1 / 0.5) + 3e-6)), 1, delta=1e-8)
        self.assertAlmostEqual(answer["membranes"][0]["area"] * 8e-6, 1, delta=1e-12)
        for value in ("-1", "nan", "inf"):
            self.fails(2, "resistance of the membrane matrix-inclusion is " + value, "at least 0", *flat[:-5], "matrix-inclusion=" + value, *flat[-4:])
        self.fails(2, "membranes between voxels with edges of 2e-05 and 1e-06", "a factor of 16", *flat[:-1], "20um")
        third = ["--phase", "9=air", "--conductivity", "air=1", "--membrane", "air-matrix=1e-6", "--pixel-size", "1um"]
        result = self.run_lamella(*bare, *third)
        self.assertEqual(result.code, 0, result.err)
        self.assertIn("no surface between the phases of the membrane matrix-air", result.err)

    def test_what_it_refuses(self):
        words = self.lattice()
        fails = lambda *rest: self.fails(*rest[:3], "diffusion", *words, *rest[3:])  # noqa: E731
        fails(2, "a ratio of 20, are more than the links of d2q9 can carry", "keep to a ratio of 5.82", "--conductivity", "wall=1:0.05",
              "--lattice", "d2q9")
        fails(2, "along and across walls on d2q5", "leave the choice", "--conductivity", "wall=1:0.5", "--lattice", "d2q5")
        fails(2, "'b' is not a number", "NAME=ALONG:ACROSS", "--conductivity", "wall=1:b")
        fails(2, "'b' is not a number", "such as --conductivity wall=0.41", "--conductivity", "other=0.3,wall=b")
        bare = [words[0]]  # without what the lumen conducts
        listed, often = [self.works("diffusion", *bare, *given, "--json").json()["effective"] for given in (
            ["--conductivity", "lumen=0.2,wall=1:0.5"], ["--conductivity", "lumen=0.2", "--conductivity", "wall=1:0.5"])]
        self.assertEqual(listed, often)
        fails(2, "two values, 1:0.5 and 1", "one value", "--conductivity", "wall=1:0.5", "--conductivity", "wall=1")
        fails(2, "finite number of at least 0", "0 for a phase", "--conductivity", "wall=1:-1")
        self.fails(3, "does not say which way the walls run", "lamella micrograph", "diffusion", "labels.png", "--conductivity",
                   "lumen=1", "--conductivity", "wall=1:0.5")
        self.works("generate", "softwood", "--size", "40,30", "-o", "plain.vti")
        self.fails(3, "no point array 'axis'", "lamella micrograph", "diffusion", "plain.vti", "--conductivity", "lumen=1",
                   "--conductivity", "wall=1:0.5")
        self.works("generate", "softwood", "--size", "20,20,20", "-o", "v.vti")
        self.fails(3, "no point array 'axis'", "lamella micrograph", "diffusion", "v.vti", "--conductivity", "lumen=1",
                   "--conductivity", "wall=1:0.5")


class Tensors(Case):
    """--conductivity-tensor, of phases that conduct differently in every direction."""

    def test_one_material(self):
        self.works("generate", "softwood", "--size", "9,8,7", "-o", "f.vti")
        given = "2 1 1.5 0.5 -0.2 0.1"
        names = [phase["name"] for phase in self.works("info", "f.vti", "--json").json()["phases"]]
        words = [word for name in names for word in ("--conductivity-tensor", f"{name}={given}")]
        answer = self.works("diffusion", "f.vti", *words, "--sides", "periodic", "--json", "--sensitivity").json()
        for row, expected in zip(answer["tensor"], ([2, 0.5, 0.1], [0.5, 1, -0.2], [0.1, -0.2, 1.5])):
            for found, number in zip(row, expected):
                self.assertAlmostEqual(found, number, delta=1e-6)
        self.assertEqual(answer["lattice"], "q1")
        self.assertEqual(answer["phases"][0]["conductivity_tensor"], [float(number) for number in given.split()])
        largest = answer["phases"][0]["conductivity"]  # the value is that of the phases' largest principal values, in proportion
        self.assertAlmostEqual(sum(answer["sensitivity"]["x"].values()) * largest, answer["effective"]["x"], delta=1e-9)
        self.assertIn("at the most; xx 2, yy 1, zz 1.5, xy 0.5, yz -0.2, xz 0.1", self.works("diffusion", "f.vti", *words).out)

    def test_tensors_of_voxels(self):
        size = (12, 10, 9)
        voxels = size[0] * size[1] * size[2]
        rows = [(2, 1, 1.5, 0.5, 0, 0)] * voxels

        def put(name):
            phases = grids.array("phase", [i // 7 % 2 for i in range(voxels)], "UInt8")
            tensors = grids.array("tensor", [number for row in rows for number in row], "Float32", 6)
            self.write(name, grids.vti([phases, tensors], "0 %d 0 %d 0 %d" % tuple(n - 1 for n in size)))

        put("t.vti")
        words = ["t.vti", "--phase", "0=a", "--phase", "1=b", "--sides", "periodic", "--json", "--no-error-estimate"]
        answer = self.works("diffusion", *words, "-o", "field.vti", "--direction", "x").json()
        self.assertAlmostEqual(answer["tensor"][0][0], 2, delta=1e-6)
        self.assertAlmostEqual(answer["tensor"][1][0], 0.5, delta=1e-6)
        self.assertNotIn("tensor", [array["name"] for array in self.info("field.vti")["point_arrays"]])
        window = self.works("diffusion", *words, "--window", "2,1,3,6,5,4", ranks=2).json()
        self.assertAlmostEqual(window["tensor"][1][1], 1, delta=1e-6)
        rows[12 * 10 * 2 + 12 * 3 + 4] = (1, 1, 1, 0, 2, 0)
        put("bad.vti")
        self.fails(2, "at voxel (4, 3, 2) is not positive definite", "of a phase that does not conduct", "diffusion", "bad.vti",
                   *words[1:])

    def test_what_it_refuses(self):
        self.works("generate", "softwood", "--size", "20,16", "-o", "s.png")
        fails = lambda *rest: self.fails(*rest[:3], "diffusion", "s.png", "--conductivity", "lumen=0.02", *rest[3:])  # noqa: E731
        fails(2, "phase 'wall' is not positive definite: its least principal value is -0.5", "all above 0", "--conductivity-tensor",
              "wall=1 1 1 1.5 0 0")
        fails(2, "5 numbers for the conductivity of 'wall'", "xx yy", "--conductivity-tensor", "wall=1 1 1 1 1")
        fails(2, "couples the third axis", "or a volume", "--conductivity-tensor", "wall=1 1 1 0 0.1 0")
        fails(2, "names 'wal'", "did you mean 'wall'", "--conductivity-tensor", "wal=1 1")
        fails(2, "phase 'wall' has a conductivity and a tensor", "give one", "--conductivity", "wall=1", "--conductivity-tensor", "wall=1 1")
        fails(2, "tensors on d2q9", "take q1", "--conductivity-tensor", "wall=1 2", "--lattice", "d2q9")
        fails(2, "phase 'wall' has no conductivity", "give one to each")


class Greys(Case):
    """Volumes of greys: shares of two phases, or conductivities between greys; voxels that are not cubes."""

    def ball(self, name, kind, of):
        n = 16
        share = lambda x, y, z: max(0.0, min(1.0, 6.8 - math.dist((x, y, z), (7.2, 7.7, 7.4))))  # noqa: E731
        values = array.array(kind, [of(share(x, y, z)) for z in range(n) for y in range(n) for x in range(n)])
        pathlib.Path(self.folder, name).write_bytes(values.tobytes())
        return name

    def effective(self, *words):
        return self.works("diffusion", *words, "--direction", "z", "--sides", "mixed", "--json").json()["effective"]["z"]

    def test_bytes_and_words_give_the_same(self):
        small = self.ball("s_16x16x16_u8.raw", "B", lambda s: round(40 + 180 * s))
        large = self.ball("l_16x16x16_u16.raw", "H", lambda s: round(4000 + 57000 * s))
        shares = ["--conductivity", "low=1,high=10", "--shares"]
        first = self.effective(small, *shares, "40,220")
        self.assertAlmostEqual(self.effective(large, *shares, "4000,61000") / first, 1, delta=1e-3)
        between = self.effective(small, "--conductivity", "40=1,220=10", "--interpolate")
        self.assertAlmostEqual(self.effective(large, "--conductivity", "4000=1,61000=10", "--interpolate") / between, 1, delta=1e-3)
        self.assertGreater(between, first)  # a voxel that is half of each conducts as half of each side by side
        long = self.effective(small, *shares, "40,220", "--pixel-size", "1um", "--slice-distance", "3um")
        self.assertGreater(long, 1.01 * first)  # along what is longer now

    def test_what_is_refused(self):
        name = self.ball("s_16x16x16_u8.raw", "B", lambda s: round(40 + 180 * s))
        fails = lambda code, *rest: self.fails(code, *rest[:2], "diffusion", name, *rest[2:])  # noqa: E731
        fails(2, "and no pixel size", "give the pixel size", "--interpolate", "--conductivity", "40=1,220=10", "--slice-distance", "2um")
        for bad in ["0", "-1", "nan", "1e300", "inf"]:
            self.fails(2, "slice distance", "above 0", "diffusion", name, "--interpolate", "--conductivity", "40=1,220=10", "--pixel-size", "1um",
                       "--slice-distance=" + bad)
        fails(2, "voxels with edges of", "a factor of 1000", "--interpolate", "--conductivity", "40=1,220=10", "--pixel-size", "1um", "--slice-distance", "1")
        fails(3, "no grey lies between 300 and 400: all are below", "lamella info", "--interpolate", "--conductivity", "300=1,400=10")
        fails(3, "no grey lies between 1 and 2: all are above", "lamella info", "--interpolate", "--conductivity", "1=1,2=10")
        fails(2, "one grey alone", "two greys", "--interpolate", "--conductivity", "40=1")
        fails(2, "'wall', which is no grey", "some greys", "--interpolate", "--conductivity", "40=1,wall=2")
        fails(2, "membranes between greys", "image of phases", "--interpolate", "--conductivity", "40=1,220=2", "--pixel-size", "1um",
              "--membrane", "40-220=1")
        fails(2, "interpolated conductivities with shares", "take one of them", "--interpolate", "--conductivity", "40=1,220=2", "--shares", "40,220")
        fails(2, "go with straight links", "d3q7", "--interpolate", "--conductivity", "40=1,220=2", "--pixel-size", "1um",
              "--slice-distance", "2um", "--lattice", "d3q19")
        self.fails(2, "'--slice-distance' is not an option", "lamella diffusion", "bond-stiffness", name, "--slice-distance", "2um")


class Ranks(Case):
    def test_any_number_of_ranks_gives_the_same(self):
        self.same_on_ranks()

    def test_any_number_of_ranks_gives_the_same_on_elements(self):
        self.same_on_ranks("--lattice", "q1")

    def same_on_ranks(self, *lattice):
        self.works("generate", "softwood", "--size", "90,80", "-o", "t.png")
        words = ["diffusion", "t.png", *CONDUCTIVITIES, *lattice, "--tolerance", "1e-11", "--json"]
        one = self.works(*words, "-o", "one.vti").json()
        for ranks in [2, 3]:
            result = self.run_lamella(*words, "-o", "r%d.vti" % ranks, ranks=ranks)
            self.assertEqual(result.code, 0, result.err)
            many = result.json()
            self.assertEqual(many["ranks"], ranks)
            for axis in "xy":
                self.assertAlmostEqual(many["effective"][axis] / one["effective"][axis], 1, delta=1e-10)
                # The fields come together in one file: the same extremes, the same phases.
                a, b = self.info("one_%s.vti" % axis), self.info("r%d_%s.vti" % (ranks, axis))
                self.assertEqual(a["phases"], b["phases"])
                for left, right in zip(a["point_arrays"], b["point_arrays"]):
                    self.assertEqual(left["name"], right["name"])
                    for (low, high), (other_low, other_high) in zip(left["range"], right["range"]):
                        scale = max(abs(low), abs(high), 1e-30)
                        self.assertLess(abs(low - other_low) / scale, 1e-6)
                        self.assertLess(abs(high - other_high) / scale, 1e-6)

    def test_a_mistake_is_told_once(self):
        result = self.run_lamella("diffusion", "nowhere.png", *CONDUCTIVITIES, ranks=2)
        self.assertNotEqual(result.code, 0)
        self.assertEqual(result.err.count("error: there is no file"), 1)

    def test_more_ranks_than_rows(self):
        self.write("p.png", pictures.png(pictures.stripes(40, 2)))
        words = ["diffusion", "p.png", *PHASES, *CONDUCTIVITIES, "--no-error-estimate"]
        result = self.run_lamella(*words, ranks=3)
        self.assertNotEqual(result.code, 0)
        self.assertEqual(result.err.count("error: 3 ranks cannot share 2 rows"), 1)
        self.assertIn("hint: start fewer ranks", result.err)
        # Refined there are rows enough.
        self.assertEqual(self.run_lamella(*words, "--refine", "4", ranks=3).code, 0)


class Segments(Case):
    def test_a_raw_scan(self):
        # Bright round lumens on a dark ground under light that falls off to the right.
        rows = []
        for y in range(120):
            row = []
            for x in range(160):
                lumen = math.hypot((x % 40) - 20, (y % 40) - 20) < 13
                row.append(int((200 if lumen else 70) * (1 - 0.3 * x / 160)) + (x * 7 + y * 13) % 9)
            rows.append(row)
        self.write("scan.png", pictures.png(rows))
        answer = self.works("diffusion", "scan.png", "--segment", "--lumen", "bright", *CONDUCTIVITIES, "--json").json()
        shares = {phase["name"]: phase["fraction"] for phase in answer["phases"]}
        # The disks' own area; the border of a disk is half a pixel uncertain, 3 % of it.
        self.assertAlmostEqual(shares["lumen"], math.pi * 13 * 13 / 1600, delta=0.03)
        self.assertEqual(answer["segmentation"]["lumens"], 12)
        self.assertEqual((answer["segmentation"]["cells"], answer["segmentation"]["doubts"]), (True, []))
        self.assertIsNone(answer["segmentation_errors"])
        # Steps without blur.
        self.assertLess(answer["segmentation"]["edge_blur"], 1.2)
        words = ("diffusion", "scan.png", "--segment", "--lumen", "bright", *CONDUCTIVITIES, "--direction", "x")
        doubtful = self.works(*words, "--segmentation-error", "--json").json()
        by, doubt = doubtful["surface_sensitivity"]["x"]["lumen:wall"], doubtful["surface_doubt"]
        self.assertEqual(doubt, doubtful["segmentation"]["surface_doubt"])
        self.assertAlmostEqual(doubtful["segmentation_errors"]["x"], doubt * abs(by) / doubtful["effective"]["x"], delta=1e-12)
        self.assertGreater(doubtful["total_errors"]["x"], doubtful["estimated_errors"]["x"])
        # What is said counts, as on any picture; the surface itself is what it is, and the same on ranks.
        twice = self.works(*words, "--surface-doubt", 2 * doubt, "--no-error-estimate", "--json", ranks=2).json()
        self.assertAlmostEqual(twice["segmentation_errors"]["x"], 2 * doubtful["segmentation_errors"]["x"], delta=1e-6)
        self.assertIn("surfaces within", self.works(*words, "--segmentation-error").out)
        # A file of the phases keeps it.
        self.works(*words, "--no-error-estimate", "-o", "phases.vti")
        again = self.works("diffusion", "phases.vti", *CONDUCTIVITIES, "--direction", "x", "--segmentation-error", "--json").json()
        self.assertAlmostEqual(again["surface_doubt"], doubt, delta=1e-12)

    def test_what_may_be_wrong_is_told(self):
        # Void, matrix and fibres, of which two phases can hold two.
        def grey(x, y):
            if math.hypot(x % 80 - 40, y % 80 - 40) < 24:
                return 30
            return 210 if math.hypot(x % 20 - 10, y % 20 - 10) < 6 else 120

        self.write("slice.png", pictures.png([[grey(x, y) + (x * 7 + y * 13) % 9 for x in range(160)] for y in range(160)]))
        result = self.run_lamella("diffusion", "slice.png", "--segment", *CONDUCTIVITIES, "--json")
        self.assertEqual(result.code, 0, result.err)
        answer = result.json()
        self.assertIn("greys", answer["segmentation"]["doubts"])
        told = next(text for text in answer["warnings"] if "3 classes of greys" in text)
        self.assertIn("warning: " + told, result.err)
        # The ranges that the warning names are phases of their own.
        words, given = [], []
        for name, greys in zip(("void", "matrix", "fibre"), re.findall(r"(\d+\.\.\d+)=NAME", told)):
            words += ["--phase", f"{greys}={name}"]
            given += ["--conductivity", f"{name}=1"]
        answer = self.works("diffusion", "slice.png", *words, *given, "--json").json()
        shares = {phase["name"]: phase["fraction"] for phase in answer["phases"]}
        self.assertAlmostEqual(shares["void"], math.pi * 24 * 24 / 6400, delta=0.01)


if __name__ == "__main__":
    unittest.main()
