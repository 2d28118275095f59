"""What the test of the pages sees and what it lets pass: small pages, of which it is known."""

import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
from compare import difference  # noqa: E402
from pages import blocks, commands, console  # noqa: E402

HERE = pathlib.Path(__file__).resolve().parent


class Compare(unittest.TestCase):
    def same(self, shown, printed, **options):
        self.assertEqual(difference(shown, printed, **options)[1], "")

    def differs(self, shown, printed, **options):
        share, text = difference(shown, printed, **options)
        self.assertTrue(text)
        self.assertGreater(share, 0)

    def test_numbers_to_the_digits_shown(self):
        self.same("x  0.2835", "x  0.2835")
        self.same("x  0.2835", "x  0.2836")
        self.differs("x  0.2835", "x  0.2837")
        self.same("1.81e+09 Pa", "1.82e+09 Pa")
        self.same("1775403 Pa, in grain", "1775402 Pa, in grain")
        self.differs("1775403 Pa", "1775401 Pa")
        self.differs("1775403 bonds", "1775402 bonds")
        self.differs("1.81e+09 Pa", "1.81e+10 Pa")
        self.differs("theta 3.882 ± 0.023", "theta 4.343 ± 0.025")
        self.differs("-1177 Pa", "1177 Pa")
        self.differs("3 569 broken bonds", "3 570 broken bonds")
        self.same("11 iterations", "12 iterations")
        self.differs("11 iterations", "20 iterations")
        self.same("residual 6.8e-07", "residual 7.4e-08")
        self.differs("residual 6.8e-07", "residual 0.1")
        self.differs("0", "1e-7")
        self.same("rattlers 26 (6.5 %)", "rattlers 30 (7.5 %)", share=0.2)
        self.differs("rattlers 26 (6.5 %)", "rattlers 40 (10 %)", share=0.2)

    def test_words_and_lines(self):
        self.same("a  b\n\nc", "a b\nc\n")
        self.differs("a b", "a c")
        self.differs("a\nb", "a")
        self.differs("a", "a\nb")
        self.differs("", "a")
        self.same("a\n…\nd", "a\nb\nc\nd")
        self.same("a\n…", "a\nb\nc")
        self.differs("a\n…\ne", "a\nb\nc\nd")
        self.same("made by … today", "made by lamella 1 today")

    def test_what_no_two_runs_share(self):
        self.same("(run: 12.94 s, everything: 13.66 s, 214.3 MB)", "(run: 2 s, everything: 3.1 s, 10 kB)")
        self.same("8.3 million points a second", "2.1 million points a second")
        self.same("wrote page.html", "wrote /some/where/page.html", folder="/some/where")
        self.differs("100 bonds, 3 s", "101 bonds, 4 s")


class Pages(unittest.TestCase):
    def run_page(self, text, *options):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for name in ("examples", "data", "docs", "tests", "build/bin"):
                (root / name).mkdir(parents=True)
            (root / "packages.txt").write_text("")
            page = root / "page.md"
            page.write_text(text)
            done = subprocess.run([sys.executable, "-B", HERE / "run_page.py", root, root / "build", "page.md", *options], capture_output=True,
                                  text=True, check=False)
            return done.returncode, done.stdout + done.stderr, page.read_text()

    def passes(self, text, *options):
        code, said, _ = self.run_page(text, *options)
        self.assertEqual(code, 0, said)
        return said

    def fails(self, text, word):
        code, said, _ = self.run_page(text)
        self.assertEqual(code, 1, said)
        self.assertIn(word, said)

    def test_commands_in_order(self):
        said = self.passes("""
```sh
mkdir -p a && cd a
export NAME=7
echo one \\
  two > file
```

Text, save as `name.py`:

```python
print(6 * 7)
```

```sh
cat file; echo $NAME
python3 name.py
```

```
42
```

```console
$ pwd | sed 's:.*/::'
a
```

```python
a = 5
```

```python
print(a)
```

```text
5
```
""")
        self.assertIn("5 blocks run, 3 outputs compared, 0 not run", said)

    def test_faults_are_found(self):
        self.fails("```sh\nfalse\n```\n", "exit code 1, not 0")
        self.fails("```sh\necho a\n```\n\n```\nb\n```\n", "not what is printed by")
        self.fails("```\nb\n```\n", "the output of no command")
        self.fails("```sh\necho error: no\n```\n\n```\nerror: no\n```\n", "should fail")
        self.fails("```python\n1 / 0\n```\n", "ZeroDivisionError")
        self.fails("```console\n$ echo 1.52\n1.50\n```\n", "not what is printed by")
        self.fails("```sh\n) (\n```\n", "did not understand")

    def test_what_should_fail(self):
        self.passes("```sh\necho error: no; false\n```\n\n```\nerror: no\n```\n")
        self.passes("<!-- ends with 8 -->\n```sh\n(exit 8)\n```\n")
        self.fails("<!-- ends with 8 -->\n```sh\ntrue\n```\n", "exit code 0, not 8")

    def test_marks(self):
        page = "<!-- not run: no display -->\n```sh\nfalse\n```\n\n```\nb\n```\n<!-- slow: an hour -->\n```sh\nfalse\n```\n"
        said = self.passes(page)
        self.assertIn("0 blocks run, 0 outputs compared, 2 not run", said)
        self.assertIn("no display", said)
        self.assertEqual(self.run_page(page, "--slow")[0], 1)

    def test_write(self):
        page = "```sh\nprintf '1\\n2\\n3\\n4\\n'\n```\n\n```\n0\n…\n5\n```\nend\n"
        self.assertEqual(self.run_page(page, "--write")[2], page.replace("0\n…\n5", "1\n…\n4"))


class Splitting(unittest.TestCase):
    def test_commands(self):
        self.assertEqual(commands("a \\\n b\n# c\n\nd &&\ne\n"), ["a \\\n b", "d &&\ne"])
        self.assertEqual(console("$ a\nb\n$ c\n"), [("a", "b\n"), ("c", "")])

    def test_blocks(self):
        found = blocks("x\n<!-- within 5 %: why -->\n```text\na\n```\n<!-- reference: made by -->\n```python\nb\n```\n")
        self.assertEqual([(b.kind, b.line, b.marks) for b in found], [("output", 3, {"within": "5"})])


if __name__ == "__main__":
    unittest.main()
