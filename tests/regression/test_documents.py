# SPDX-License-Identifier: BSD-3-Clause
"""The documentation says what is true.

Guards against parameter pages that were not generated anew, links that lead nowhere, commands and decks of
the README and the guide that no longer work, and examples that differ from what their page shows.
"""

import pathlib
import re
import shlex
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "docs/tools"))
import harmos_runs as runs  # noqa: E402
import parameter_pages  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Documents(unittest.TestCase):
    def test_parameter_pages_are_what_the_programs_print(self):
        for program in ("signorini", "harmos", "fiber_composite", "study"):
            printed = runs.start(["--print-parameters", "markdown"], np=1, program=program)
            self.assertEqual(printed.returncode, 0, printed.stderr)
            for path, text in parameter_pages.pages(program, printed.stdout).items():
                self.assertEqual((ROOT / path).read_text(encoding="utf-8"), text,
                                 f"{path}: generate it by docs/tools/parameter_pages.py")
            for line in printed.stdout.splitlines():
                # Neither a cell nor the meaning of a choice is empty.
                self.assertNotRegex(line, r"\|\s*\||: (;|\|)", program)

    def test_links_lead_somewhere(self):
        for page in [ROOT / "README.md", *ROOT.glob("docs/**/*.md"), *ROOT.glob("packages/*/README.md")]:
            text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.S)
            for target in re.findall(r"\]\(([^)#]+)\)", text):
                if "://" not in target:
                    self.assertTrue((page.parent / target).exists(), f"{page}: {target}")

    def test_commands_run(self):
        """The blocks of shell commands of these pages, with their output directory moved.

        Pictures are drawn as the page says; what bootstraps, configures or builds is left out, for
        whoever runs this test has done it.
        """
        for page in ("README.md", "docs/scenes.md", "docs/clusters.md"):
            text = (ROOT / page).read_text(encoding="utf-8")
            blocks = [b for b in re.findall(r"```sh\n(.*?)```", text, re.S) if "build/bin/" in b]
            self.assertTrue(blocks, page)
            for block in blocks:
                self.run_block(page, block)

    PICTURES = {"plot_run.py": ["solution.png"], "plot_scaling.py": ["scaling.png"]}

    def run_block(self, page, block):
        directory = runs.scratch()
        for line in block.replace("\\\n", " ").splitlines():
            words = shlex.split(line, comments=True)
            if not words:
                continue
            words = [str(directory) if word == "run" else word for word in words]
            words = [str(ROOT / w) if (ROOT / w).exists() and "/" in w else w for w in words]
            with self.subTest(page=page, line=line):
                if words[0] == "mpirun":
                    self.assertEqual(words[1], "-np")
                    program, *rest = words[3:]
                    np = int(words[2])
                else:
                    program, *rest = words
                    np = 0
                if program.endswith("python3"):
                    status, out, err = runs.execute([sys.executable, *rest])
                    self.assertEqual(status, 0, err)
                    for picture in self.PICTURES.get(pathlib.Path(rest[0]).name, ()):
                        self.assertTrue((directory / picture).exists(), picture)
                    continue
                self.assertIn("/bin/", program)
                done = runs.start(rest, np=np, program=pathlib.Path(program).name)
                self.assertEqual(done.returncode, 0, done.stderr)
                if str(directory) in rest:
                    left = "plan.json" if "--plan" in rest else "summary.json"
                    self.assertTrue((directory / left).exists())

    def test_examples_are_shown_as_they_are_and_print_what_is_shown(self):
        """Pages that show an example: its source, word for word, and its output on 1 and 2 ranks."""
        page = (ROOT / "docs/qp.md").read_text(encoding="utf-8")
        source = (ROOT / "docs/examples/obstacle.cpp").read_text(encoding="utf-8")
        self.assertIn(f"```cpp\n{source}```", page)
        self.assertLess(len(source.splitlines()), 60)
        shown = page.split("any number of ranks it prints\n\n```\n")[1].split("```")[0]
        for np in (1, 2):
            status, out, err = runs.execute([*runs.launcher(np), runs.BINARY / "examples/example_obstacle"])
            self.assertEqual((status, out), (0, shown), err)

    def test_programs_print_what_pages_say_they_print(self):
        """`mpirun -np N build/examples/PROGRAM` prints: what stands below; the same on more ranks."""
        said = re.compile(r"`mpirun -np (\d+) build/examples/(\w+)` prints:\n\n```\n(.*?)```", re.S)
        found = set()
        for page in ROOT.glob("docs/*.md"):
            for np, program, shown in said.findall(page.read_text(encoding="utf-8")):
                found.add(program)
                for ranks in (int(np), 4):
                    with self.subTest(program=program, ranks=ranks):
                        status, out, err = runs.execute(
                            [*runs.launcher(ranks), runs.BINARY / "examples" / program]
                        )
                        self.assertEqual((status, out), (0, shown), err)
        examples = {f"example_{path.stem}" for path in (ROOT / "docs/examples").glob("embed_*.cpp")}
        self.assertEqual(found, examples)

    def test_quoted_code_is_that_of_the_file(self):
        """A block of code below a paragraph that ends in "`path`:" stands in that file, word for word."""
        quoted = re.compile(r"`([\w/.]+)`:\n\n```\w+\n(.*?)```", re.S)
        found = []
        for page in ROOT.glob("docs/**/*.md"):
            for path, code in quoted.findall(page.read_text(encoding="utf-8")):
                with self.subTest(page=page.name, path=path):
                    self.assertIn(code, (ROOT / path).read_text(encoding="utf-8"))
                found.append(path)
        self.assertTrue(found)

    def test_every_hard_case_has_its_row_and_its_test(self):
        """The table of docs/stability.md names each test of tests/stability once, and no other.

        They are declared for 1, 2 and 4 ranks, and the page has figures measured by them.
        """
        text = (ROOT / "docs/stability.md").read_text(encoding="utf-8")
        rows = [line for line in text.splitlines() if re.match(r"\| .*`\w+` \|$", line)]
        named = [re.search(r"`(\w+)` \|$", row).group(1) for row in rows]
        directory = ROOT / "tests/stability"
        tests = [name for source in sorted(directory.glob("*.cpp"))
                 for name in re.findall(r"TEST\(Stability, (\w+)\)", source.read_text(encoding="utf-8"))]
        self.assertEqual(sorted(named), sorted(tests))
        for row in rows:
            cells = [cell.strip() for cell in row.strip("|").split("|")]
            self.assertEqual(len(cells), 5, row)
            self.assertTrue(all(cells), row)
            self.assertRegex(cells[3], r"\d", f"how it behaves, with a figure: {row}")
        declared = (directory / "CMakeLists.txt").read_text(encoding="utf-8")
        self.assertIn("RANKS 1 2 4", declared)
        for source in directory.glob("test_*.cpp"):
            self.assertRegex(declared, rf"(\b|_){source.stem[5:]}\b")

    def test_decks_that_are_named_exist(self):
        for page in ("README.md", "docs/scenes.md", "docs/accuracy.md"):
            text = (ROOT / page).read_text(encoding="utf-8")
            for deck in re.findall(r"`(apps/[^`]*\.xml)`", text):
                self.assertTrue(list(ROOT.glob(deck)), deck)

    def test_every_deck_of_harmos_has_its_place_and_picture_in_the_guide(self):
        text = (ROOT / "docs/scenes.md").read_text(encoding="utf-8")
        decks = sorted((ROOT / "apps/harmos/decks").glob("*.xml"))
        self.assertTrue(decks)
        for deck in decks:
            self.assertIn(f"`{deck.name}`", text)
            picture = ROOT / f"docs/images/{deck.stem}.png"
            self.assertIn(f"](images/{picture.name})", text)
            self.assertLess(picture.stat().st_size, 150_000, picture)

    def test_decks_shown_in_the_guide_are_valid(self):
        """The deck that the guide builds up, as it stands there."""
        text = (ROOT / "docs/scenes.md").read_text(encoding="utf-8")
        shown = re.findall(r"```xml\n(.*?)```", text, re.S)
        self.assertTrue(shown)
        for number, deck in enumerate(shown):
            path = runs.scratch().with_suffix(f".{number}.xml")
            path.write_text(deck, encoding="utf-8")
            runs.solved(self, path, program="harmos")


if __name__ == "__main__":
    runs.main()
