"""lamella report: one page of a folder, that needs no other file; what is missing, damaged, hostile or too large."""

import json
import os
import re
import unittest

import pictures
from pages import Page
from program import Case

PICTURE = pictures.png(pictures.stripes(64, 40))

SWEEP = """title = "Heat <through> softwood"

[sample]
generate = "softwood"
size = [48, 48]
solid-fraction = [0.3, 0.4, 0.5]
seed = "1..3"

[diffusion]
conductivity = { lumen = [0.02, 0.2], wall = 1 }
direction = "x"

[[picture]]
name = "heat"
of = "diffusion"
array = "temperature"
size = [400, 300]

[measure]
conductivity = "diffusion.effective.x"
nodes = "diffusion.nodes"
wall = "sample.phases.wall.fraction"
"""


class Report(Case):
    def page(self, name="results/report.html"):
        with open(self.path(name), encoding="utf-8") as file:
            page = Page(file.read())
        self.assertEqual(page.faults(), [])
        return page

    def fill(self, **files):
        os.makedirs(self.path("results"), exist_ok=True)
        for name, data in files.items():
            data = json.dumps(data) if isinstance(data, (dict, list)) else data
            name = "results/" + name.replace("__", ".")
            os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
            self.write(name, data if isinstance(data, bytes) else data.encode())

    def ordered(self, section, **files):
        self.fill(report__json={"title": "T", "sections": [{"title": "S", **section}]}, **files)

    def test_what_commands_leave(self):
        os.makedirs(self.path("results"))
        self.works("generate", "honeycomb", "--size", "64,64", "-o", "results/cells.png")
        solved = self.works("diffusion", "results/cells.png", "--conductivity", "lumen=0.1", "--conductivity", "wall=1", "-o", "results/k.vti", "--json")
        self.fill(k__json=solved.out)
        said = self.works("report", "results", "--json").json()
        self.assertEqual((said["pictures"], said["problems"], said["ordered"]), (1, [], False))
        page = self.page()
        for words in ("results", "cells.png", "lamella diffusion results/cells.png", "effective", "Provenance", "Times", "k_x.vti"):
            self.assertIn(words, page.text)
        self.assertEqual(page.tags.count("img"), 1)
        self.fails(7, "exists already", "--overwrite", "report", "results")
        self.assertEqual(self.works("report", "results", "--overwrite", "--json").json()["bytes"], os.path.getsize(self.path("results/report.html")),
                         "the page does not show itself")

    def test_tables_that_rise_are_drawn(self):
        rising = "strain,stress,name\n" + "".join(f"{i},{i * i},a\n" for i in range(10))
        self.fill(curve__csv=rising, curve__csv__json={"columns": {"stress": {"unit": "Pa"}}},
                    other__csv="a,b\n3,1\n1,2\n")
        said = self.works("report", "results", "--json").json()
        self.assertEqual((said["charts"], said["tables"]), (1, 2))
        self.assertIn("stress [Pa]", self.page().text)

    def test_a_scenes_folder(self):
        rows = "".join(f"{k},{k / 10},{k * k}\n" for k in range(12))
        self.fill(**{"lamella-results__json": {"format": 1}, "scene__toml": "[fracture]\nradius = 4 # <b>\n", "table__csv": "key,alpha,strength\n" + rows,
                       "settings__csv": "key,alpha,strength.mean\n" + rows, "samples/ab/record__json": {"key": "ab", "seconds": 1},
                       "samples/ab/field__png": PICTURE, "samples/cd/failure__json": {"error": "nothing carries the load", "hint": "more"}})
        said = self.works("report", "results", "--json").json()
        self.assertEqual((said["pictures"], said["tables"], said["problems"]), (1, 2, []))
        page = self.page()
        for words in ("Samples that are finished: 1", "radius = 4 # <b>", "samples/cd/failure.json: nothing carries the load", "samples/ab"):
            self.assertIn(words, page.text)
        self.assertNotIn("record.json", page.text)

    def sweep(self, text, *words):
        self.write("sweep.toml", text.encode())
        self.works("run", "sweep.toml", "--results", "results", "--quiet", *words)
        said = self.works("report", "results", "--overwrite", "--json").json()
        self.assertEqual(said["problems"], [])
        return said, self.page()

    def in_order(self, page, *words):
        """These stand in the page, each behind the one before it."""
        at = 0
        for word in words:
            self.assertIn(word, page.text[at:], f"behind {page.text[max(0, at - 60):at]}")
            at = page.text.index(word, at) + len(word)

    def test_a_sweep(self):
        said, page = self.sweep(SWEEP)
        self.assertEqual(said["title"], "Heat <through> softwood")
        # conductivity over two keys and wall over one, three seeds averaged over; every sample has its picture
        self.assertEqual((said["charts"], said["pictures"]), (3, 18))
        self.assertLess(said["bytes"], 5e6)
        self.in_order(
            page, "Heat <through> softwood", "18 samples. Swept:", "sample.solid-fraction : 0.3, 0.4, 0.5", "sample.seed : 1, 2, 3, averaged over",
            "diffusion.conductivity.lumen : 0.02, 0.2", "The same in all samples: nodes 2304", "conductivity.lumen 0.02", "conductivity.lumen 0.2",
            "conductivity over sample.solid-fraction . Means of 3 samples, over sample.seed ; bars: standard deviation of a sample.",
            "conductivity over diffusion.conductivity.lumen", "It does not depend on sample.seed and diffusion.conductivity.lumen .",
            "wall over sample.solid-fraction . One sample each.", "Pictures", "heat", "solid-fraction 0.3, seed 1, conductivity.lumen 0.02",
            "solid-fraction 0.5, seed 3, conductivity.lumen 0.2", "settings.csv : mean ± standard deviation of a sample", "Scene", "[diffusion]",
            "18 samples, one after the other")
        self.assertIn('<div class="grid c4">', page.source, "two pairs of the key that changes fastest")
        # a bar in each place: three solid fractions of two series, and the other way round
        self.assertEqual(len(re.findall(r"H[\d.]+M[\d.]+ [\d.]+V[\d.]+M", page.source)), 12)

    def test_a_sweep_over_words_with_errors_that_are_told(self):
        said, page = self.sweep("""
[sample]
generate = "honeycomb"
size = [64, 64]

[bond-stiffness]
young = { wall = [1e9, 1e10] }
surface-correction = true
micromodulus = ["continuum", "isotropic"]

[measure]
E = "bond-stiffness.constants.E_x.value"
E_error = "bond-stiffness.constants.E_x.estimated_error"
""")
        self.assertEqual(said["title"], "sweep", "the scene's name where it has no title")
        for words in ("E [", "Pa]", "One sample each; bars: its error as the command tells it, E_error .", "bond-stiffness.young.wall [Pa]", "young.wall 10⁹ Pa", "isotropic"):
            self.assertIn(words, page.text)
        with open(self.path("results/table.csv.json"), encoding="utf-8") as file:
            columns = json.load(file)["columns"]
        self.assertEqual(columns["E"], {"unit": "Pa", "meaning": "bond-stiffness.constants.E_x.value"})

    def test_a_page_of_many_samples_stays_small(self):
        count = 700
        noise = [pictures.png([[tuple(os.urandom(3)) for _ in range(120)] for _ in range(90)], colour=True) for _ in range(3)]
        rows = "".join(f"s{i},{i // 2},{i % 2},{'failed' if i == 9 else 'done'},{i * i}\n" for i in range(count))
        self.fill(**{"lamella-results__json": {"format": 1}, "scene__toml": "# a\n" * 700000,
                     "table__csv": "sample,a.width,a.seed,status,strength\n" + rows, "settings__csv": "a.width,n\n1,2\n",
                     "samples/s9/failure__json": {"error": "too thin"}},
                  **{f"samples/s{i}/{name}__png": noise[i % 3] for i in range(count) if i != 9 for name in ("damage", "film_0001", "film_0002")})
        result = self.run_lamella("report", "results", "--json")
        said = result.json()
        self.assertEqual((said["charts"], said["pictures"]), (1, 300))
        self.assertGreater(said["bytes"], 2e6)
        self.assertLess(said["bytes"], 5e6)
        self.assertEqual(said["problems"], ["there is no room for the scene in a page of 5.0 MB at most"])
        page = self.page()
        for words in ("700 samples, of which 1 failed.", "0 to 349 (350 values)", "150 of 700 samples.", "The last of up to 2 steps.",
                      "width 4, seed 1: samples/s9/failure.json: too thin"):
            self.assertIn(words, page.text)

    def test_a_hostile_sweep(self):
        evil = '"><script>alert(1)</script>'
        quoted = '"' + evil.replace('"', '""') + '"'
        self.fill(**{"lamella-results__json": {"format": 1}, "scene__toml": evil,
                     "table__csv": f"sample,{quoted},a.b,status,{quoted},m\n" + "".join(f"../../etc,{w},{w},done,{i},{i}\n" for i, w in enumerate([quoted, "x", "`y`"])),
                     "table__csv__json": {"columns": {"m": {"unit": evil, "meaning": evil}}, "provenance": {"parameters": {"scene": {"title": evil, "file": evil}}}},
                     "samples/ab/p__png": PICTURE, "settings__csv": f"{quoted},a.b,n\n", "times__csv": "seconds\n<b>\n"})
        said = self.run_lamella("report", "results", "--json").json()
        self.assertEqual(said["title"], evil)
        self.assertGreater(said["charts"], 0)
        self.page()
        for table in ('sample,status\n"', "sample,a.b,status,m\n", "sample,a.b,status,m\nx,nan,done,1\ny,1e308,done,inf\nz,-1e308,done,2\n", "sample,sample\n1"):
            self.fill(table__csv__json={"provenance": [1], "columns": 3}, table__csv=table)
            self.run_lamella("report", "results", "--json", "--overwrite").json()
            self.page()

    def test_an_ordered_page(self):
        self.ordered(
            {"text": ["**One** paragraph.", "Another, with [a link](https://doi.org/10.1000/1)."],
             "figures": [{"file": "p.png", "number": "4", "caption": "*Stripes*", "alt": "stripes"}],
             "curves": [{"file": "m.csv", "x": "width", "y": "value", "error": "error", "group": "kind", "log": "y"}],
             "tables": [{"file": "m.csv", "rows": 2, "columns": [
                 {"name": "width", "label": "α"}, {"name": "value", "unit": "MPa", "factor": 1e-6, "decimals": 2, "error": "error"}]}]},
            p__png=PICTURE, m__csv="width,value,error,kind\n1,1.234e6,5e4,a\n2,2e6,1e5,a\n3,4e6,1e5,b\n", unused__png=PICTURE)
        said = self.works("report", "results", "-o", "page.html", "--title", "Mine", "--json").json()
        self.assertEqual((said["pictures"], said["charts"], said["tables"], said["title"]), (1, 1, 1, "Mine"))
        page = self.page("page.html")
        for words in ("Mine", "One paragraph.", "4 Stripes", "kind a", "kind b", "1.23 ± 0.05", "2 of 3 rows", "[MPa]"):
            self.assertIn(words, page.text)
        self.assertEqual(page.links, ["https://doi.org/10.1000/1"])

    def test_hostile_names_and_texts_are_shown_not_run(self):
        evil = '"><script>alert(1)</script>'
        self.ordered(
            {"text": f"a {evil} [x](javascript:alert(1)) ![p](http://example.org/p.png)", "discussion": f"<img src=x onerror=alert(1)> {evil}",
             "figures": [{"file": "p.png", "alt": evil, "caption": evil, "number": evil}],
             "tables": [{"file": "t.csv", "caption": evil}], "curves": [{"file": "t.csv", "x": "x", "y": "y", "x_label": evil, "caption": evil}],
             "comparison": [{"what": evil, "paper": evil, "ours": evil, "unit": evil, "why": evil, "difference": evil}]},
            p__png=PICTURE, t__csv="x,y,<b>\n1,2,<script>alert(2)</script>\n2,3,\"& \"\"q\"\"\"\n", run__json={"warnings": [evil], evil: evil},
            scene__toml=f"# {evil}\n")
        self.works("report", "results", "--title", evil)
        page = self.page()
        self.assertIn("<script>alert(2)</script>", page.text)
        self.assertNotIn("b", page.tags[page.tags.index("body"):page.tags.index("figure")])

    def test_missing_and_damaged_pieces_are_named(self):
        self.ordered(
            {"figures": [{"file": "none.png"}, {"file": "half.png"}, {"file": "empty.png"}, {"file": "text.png"}, {"file": "p.png"}, {"file": "a.gif"},
                         {"file": "half.svg"}],
             "tables": [{"file": "none.csv"}, {"file": "t.csv", "columns": ["lenght"]}, {"file": "empty.csv"}, {"file": "binary.csv"}],
             "curves": [{"file": "t.csv", "x": "name", "y": "length"}],
             "comparison": [{"what": "w", "paper": 1, "ours": {"file": "t.csv", "column": "length", "where": {"name": "c"}}}]},
            half__png=PICTURE[: len(PICTURE) // 2], empty__png=b"", text__png=b"not a picture", p__png=PICTURE, a__gif=b"GIF89a",
            half__svg=b"<svg><path/>", t__csv="name,length\na,1\nb,2\n", empty__csv=b"", binary__csv=bytes(range(256)) * 8, half__json='{"a": ')
        now = {"SOURCE_DATE_EPOCH": "0"}
        result = self.run_lamella("report", "results", "--json", environment=now)
        self.assertEqual(result.code, 0, result.err)
        problems = result.json()["problems"]
        warnings = result.err.splitlines()
        self.assertEqual(len(problems), 13, problems)
        self.assertEqual(warnings, ["warning: " + one for one in problems], "one line each")
        for name in ("none.png", "half.png", "empty.png", "text.png", "a.gif", "half.svg", "none.csv", "empty.csv", "binary.csv", "half.json"):
            self.assertEqual(sum(name in one for one in problems), 1, name)
        self.assertIn("'t.csv' has no column 'lenght'", problems)
        page = self.page()
        for problem in problems:
            self.assertIn(problem, page.text)
        self.assertEqual(page.tags.count("img"), 1)
        strict = self.run_lamella("report", "results", "--strict", "--overwrite", "--quiet", environment=now)
        self.assertEqual(strict.code, 3)
        self.assertIn("error: 13 of the pieces are missing or damaged", strict.err)
        self.assertEqual(self.page().text, page.text.replace("--json", "--strict --overwrite --quiet"))

    def test_pictures_wider_than_the_page(self):
        self.fill(wide__png=pictures.png(pictures.stripes(400, 30)), small__png=PICTURE)
        said = self.works("report", "results", "--picture-width", "200", "--json").json()
        self.assertEqual(said["scaled"], 1)
        self.assertIn("shown 200 pixels wide; the file has 400 × 30", self.page().text)
        self.fails(2, "--picture-width 3", "pixels", "report", "results", "--picture-width", "3", "-o", "x.html")

    def test_what_is_refused(self):
        self.fails(3, "there is no folder 'none'", "wrote to", "report", "none")
        self.write("file", b"")
        self.fails(3, "'file' is a file, not a folder", "wrote to", "report", "file")
        os.makedirs(self.path("results"))
        self.fails(3, "the folder 'results' is empty", "wrote to", "report", "results", "-o", "x.html")
        self.fill(report__json='{"title": "x"')
        self.fails(3, "report.json' is no JSON", "docs/commands/report.md", "report", "results")
        self.fill(report__json={"sections": [{"title": "a", "figure": []}]})
        self.fails(3, "sections[0].figure is not known", "did you mean 'figures'?", "report", "results")
        self.fill(report__json={"sections": [{"title": "a", "figures": [{"file": "../secret.png"}]}]})
        self.fails(3, "lies outside the folder", "copy the file", "report", "results")
        self.fails(2, "'x.pdf': pages are written as .html", "end the name", "report", "results", "-o", "x.pdf")
        self.fill(report__json="[" * 100000)
        self.fails(3, "report.json", "", "report", "results")

    def test_a_large_folder(self):
        self.fill(**{f"f{i:03d}__png": PICTURE for i in range(110)}, **{f"t{i:03d}__csv": "a,b\n1,2\n" for i in range(60)},
                    deep__json="[" * 90 + "]" * 90, deeper__json='{"a":' * 5000 + "1" + "}" * 5000)
        result = self.run_lamella("report", "results", "--json")
        said = result.json()
        self.assertEqual((said["pictures"], said["tables"]), (100, 50))
        self.assertEqual(said["problems"], ["'deeper.json' is nested too deep"])
        self.assertIn("100 of 110 pictures are shown", self.page().text)


if __name__ == "__main__":
    unittest.main()
