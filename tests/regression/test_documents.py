# SPDX-License-Identifier: BSD-3-Clause
"""The documentation is true.

Guards against stale parameter pages, dead links, commands and decks of the README and the guides that no
longer work, examples that differ from their page, figures that nobody measured, and constants that differ
from the code.
"""

import json
import pathlib
import re
import shlex
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "performance"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "performance/peer"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "performance/messages"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "docs/tools"))
import harmos_runs as runs  # noqa: E402
import headline_page  # noqa: E402
import parameter_pages  # noqa: E402
import performance_model  # noqa: E402
import performance_tables  # noqa: E402
import real_bodies_page  # noqa: E402
import unstructured_page  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]


def pages():
    """All pages but the changelog."""
    places = ("docs/**/*.md", "packages/*/README.md", "tests/**/README.md")
    return [ROOT / "README.md", *(page for place in places for page in sorted(ROOT.glob(place)))]


def anchors(page):
    """The headings of a page, as links call them."""
    text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.S)
    headings = re.findall(r"^#+ (.*)$", text, re.M)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


class Documents(unittest.TestCase):
    def test_parameter_pages_are_what_the_programs_print(self):
        for program in filter(runs.is_built, parameter_pages.PROGRAMS):
            printed = runs.start(["--print-parameters", "markdown"], np=1, program=program)
            self.assertEqual(printed.returncode, 0, printed.stderr)
            for path, text in parameter_pages.pages(program, printed.stdout).items():
                self.assertEqual((ROOT / path).read_text(encoding="utf-8"), text,
                                 f"{path}: generate it by docs/tools/parameter_pages.py")
            for line in printed.stdout.splitlines():
                # Neither the meaning of a parameter nor that of a choice is empty.
                self.assertNotRegex(line, r"^\* .*`\. *$|^ +\* `[^`]*`: *$", program)

    def test_links_lead_somewhere(self):
        """To files that exist, and with an anchor to a heading as GitHub names it."""
        for page in pages():
            text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.S)
            for link in re.findall(r"\]\(([^)]+)\)", text):
                target, _, anchor = link.partition("#")
                if "://" in link:
                    continue
                file = page.parent / target if target else page
                self.assertTrue(file.exists(), f"{page}: {link}")
                if anchor:
                    self.assertIn(anchor, anchors(file), f"{page}: {link}")

    def test_lines_are_not_wider_than_120_columns(self):
        """In the changelog too. Two kinds of lines may be wider: a line of one word with a URL, which cannot be
        broken; and a line of a code block without a language, or of text, which quotes a program's output.
        """
        for page in [*pages(), ROOT / "CHANGELOG.md"]:
            language = None  # of the block of code
            for line in page.read_text(encoding="utf-8").splitlines():
                if line.lstrip().startswith("```"):
                    language = line.strip("` ") if language is None else None
                elif language not in ("", "text") and (len(line.split()) > 1 or "://" not in line):
                    self.assertLessEqual(len(line), 120, f"{page.relative_to(ROOT)}: {line}")

    def test_index_has_every_page(self):
        text = (ROOT / "docs/README.md").read_text(encoding="utf-8")
        for page in [*ROOT.glob("docs/*.md"), *ROOT.glob("docs/parameters/*.md")]:
            if page.name != "README.md":
                self.assertIn(f"]({page.relative_to(ROOT / 'docs').as_posix()}", text)

    def test_names_in_the_theory_are_in_the_code(self):
        """What its sections on signs and symbols name is in a header, or is a parameter's name."""
        text = (ROOT / "docs/theory.md").read_text(encoding="utf-8").split("\n## Signs\n")[1]
        headers = [path.read_text(encoding="utf-8") for path in ROOT.glob("packages/*/src/**/*.hpp")]
        sources = [path.read_text(encoding="utf-8") for path in
                   [*ROOT.glob("packages/*/src/**/*.?pp"), *ROOT.glob("apps/*/*.cpp")]]
        names = set(re.findall(r"`([^`]+)`", text))
        self.assertGreater(len(names), 50)
        for name in sorted(names):
            with self.subTest(name=name):
                if " " in name or name in ("Gap", "Density", "Pressure"):
                    self.assertTrue(any(f'"{name}"' in text for text in sources), name)
                    continue
                owner, _, member = name.removesuffix("()").rpartition("::")
                places = headers
                if owner and owner not in ("effects", "feti"):
                    place = re.compile(rf"\b(class|struct) {owner.removeprefix('feti::')}\b[^;]*{{")
                    places = [text for text in headers if place.search(text)]
                said = re.compile(rf"\b{member}\b")
                self.assertTrue(any(said.search(text) for text in places), name)

    def test_commands_run(self):
        """The blocks of shell commands of these pages, with their output directory moved.

        Pictures are drawn as the page says; what bootstraps, configures or builds is left out, for
        whoever runs this test has done it.
        """
        self.run_pages("README.md", "docs/scenes.md", "docs/clusters.md")

    def run_pages(self, *pages):
        for page in pages:
            text = (ROOT / page).read_text(encoding="utf-8")
            blocks = [b for b in re.findall(r"```sh\n(.*?)```", text, re.S) if "build/bin/" in b]
            self.assertTrue(blocks, page)
            for block in blocks:
                self.run_block(page, block)

    @staticmethod
    def pictures_of(words):
        """What a tool's command draws; nothing if it draws nothing."""
        tool = pathlib.Path(words[0]).name
        if tool == "harmos-plot":
            drawn = {"--scaling": ["scaling.png"], "--parts": ["parts.png"], "--curve": ["curve.png"], "--shape": ["shape.png"],
                     "--rounds": ["rounds.png"], "--frames": ["solution.png", "frame_0001.png", "steps.gif"]}
            return next((drawn[word] for word in words if word in drawn), ["solution.png"])
        return ["*.png"] if tool.startswith(("plot", "draw")) else []

    def run_block(self, page, block):
        directory = runs.scratch()
        for line in block.replace("\\\n", " ").splitlines():
            words = shlex.split(line, comments=True)
            if not words:
                continue
            # "# status 1" behind a command that does not end with 0.
            status_said = re.search(r"# status (\d+)\s*$", line)
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
                tool = pathlib.Path(program).name.startswith("harmos-")
                if tool or program.endswith("python3"):
                    for picture in directory.glob("*.png"):
                        picture.unlink()
                    command = [runs.BINARY / "bin" / pathlib.Path(program).name] if tool else [sys.executable]
                    status, out, err = runs.execute([*command, *rest])
                    self.assertEqual(status, 0, err)
                    for picture in self.pictures_of(words if tool else rest):
                        self.assertTrue(list(directory.glob(picture)), picture)
                    continue
                self.assertIn("/bin/", program)
                done = runs.start(rest, np=np, program=pathlib.Path(program).name)
                said = int(status_said.group(1)) if status_said else 0
                self.assertEqual(done.returncode, said, done.stderr)
                if str(directory) in rest:
                    leaves = {"--plan": "plan.json", "--parts": "parts.vtkhdf"}
                    left = next((leaves[word] for word in rest if word in leaves), "summary.json")
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
        examples = {f"example_{path.stem}" for path in (ROOT / "docs/examples").glob("*.cpp")}
        examples.remove("example_obstacle")  # which stands in its page as a whole, see above
        self.assertEqual(found, examples)

    def test_quoted_code_is_that_of_the_file(self):
        """A block of code below a paragraph that ends in "`path`:" stands in that file, word for word."""
        quoted = re.compile(r"`([\w/.]+)`:\n\n```\w+\n(.*?)```", re.S)
        found = []
        for page in pages():
            for path, code in quoted.findall(page.read_text(encoding="utf-8")):
                with self.subTest(page=page.name, path=path):
                    self.assertIn(code, (ROOT / path).read_text(encoding="utf-8"))
                found.append(path)
        self.assertTrue(found)

    def test_developers_guide_lists_packages_and_labels(self):
        """All of them, once; the presets that it names are there."""
        text = (ROOT / "docs/developing.md").read_text(encoding="utf-8")
        row = re.compile(r"^\* \[(\w+)\]\(\.\./packages/(\w+)/README\.md\):(.*(?:\n  .*)*)", re.M)
        listed = row.findall(text)
        packages = sorted(path.parent.name for path in ROOT.glob("packages/*/CMakeLists.txt"))
        self.assertEqual(sorted(name for name, _, _ in listed), packages)
        for name, link, files in listed:
            self.assertEqual(name, link)
            for file in re.findall(r"`(\w+\.hpp)`", files):
                places = list((ROOT / "packages" / name / "src").rglob(file))
                self.assertEqual(len(places), 1, file)
        section = text.split("| Label | What |\n|---|---|\n")[1].split("\n\n")[0]
        labels = re.findall(r"^\| `(\w+)` \|", section, re.M)
        used = set()
        for file in ROOT.glob("tests/**/CMakeLists.txt"):
            for names in re.findall(r"LABELS ((?:[a-z]+ ?)+)", file.read_text(encoding="utf-8")):
                used.update(names.split())
        self.assertEqual(sorted(labels), sorted(used))
        presets = (ROOT / "CMakePresets.json").read_text(encoding="utf-8")
        for name in ("release", "dev", "asan", "ubsan"):
            self.assertIn(f'"name": "{name}"', presets)
        for path in re.findall(r"`((?:packages|tests|docs|apps|cmake)/[\w/]+\.\w+)`", text):
            self.assertTrue("NAME" in path or (ROOT / path).exists(), path)

    def test_architecture_is_drawn_as_it_is(self):
        """Boxes and arrows of the picture: all packages, and what can be reached from each."""
        picture = (ROOT / "docs/images/architecture.svg").read_text(encoding="utf-8")
        drawn = set(re.findall(r'id="package-(\w+)"', picture))
        packages = {path.parent.name for path in ROOT.glob("packages/*/CMakeLists.txt")}
        self.assertEqual(drawn, packages | {"apps"})
        arrows = re.findall(r'id="link-(\w+)-(\w+)"', picture)
        down = {name: {other for one, other in arrows if one == name} for name in drawn}
        for name in sorted(drawn):
            seen, found = set(), {name}
            while found:
                seen |= found
                found = {other for one in found for other in down[one]} - seen
            place = ROOT / ("apps" if name == "apps" else f"packages/{name}")
            linked = set()
            for file in place.rglob("CMakeLists.txt"):
                linked |= set(re.findall(r"\bHarmos::(\w+)", file.read_text(encoding="utf-8")))
            # All links can be followed in the picture, and no arrow leads where nothing is linked.
            self.assertLessEqual(linked, seen - {name}, name)
            self.assertLessEqual(down[name], linked, name)

    def test_headline_figures_are_those_of_the_measurement(self):
        """docs/headline.json → docs/headline.md and the README's sentence, word for word."""
        text = (ROOT / "docs/headline.json").read_text(encoding="utf-8")
        document = json.loads(text)
        remedy = "write it by tests/performance/headline.py --render"
        self.assertEqual(headline_page.as_json(document), text, "docs/headline.json")
        self.assertFalse(document["quick"])
        page = (ROOT / "docs/headline.md").read_text(encoding="utf-8")
        self.assertEqual(headline_page.page(document), page, f"docs/headline.md: {remedy}")
        readme = (ROOT / "README.md").read_text(encoding="utf-8")
        self.assertEqual(headline_page.with_block(readme, document), readme, f"README.md: {remedy}")
        # The page has the same digits.
        block = headline_page.readme_block(document)
        shown = set(re.findall(r"\d[\d.]*", page))
        for figure, unit in re.findall(r"(\d[\d.]*) (s\b|GiB|GB)", block):
            self.assertIn(figure, shown, f"{figure} {unit} of the README")

    def test_seconds_beside_multigrid_are_those_of_the_measurement(self):
        """docs/unstructured.json → docs/unstructured.md, word for word."""
        text = (ROOT / "docs/unstructured.json").read_text(encoding="utf-8")
        document = json.loads(text)
        remedy = "write it by tests/performance/unstructured.py --render"
        self.assertEqual(unstructured_page.as_json(document), text, "docs/unstructured.json")
        page = (ROOT / "docs/unstructured.md").read_text(encoding="utf-8")
        self.assertEqual(unstructured_page.page(document), page, f"docs/unstructured.md: {remedy}")

    def test_products_on_real_bodies_are_those_of_the_measurement(self):
        """docs/real_bodies.json → docs/real_bodies.md, word for word."""
        text = (ROOT / "docs/real_bodies.json").read_text(encoding="utf-8")
        document = json.loads(text)
        remedy = "write it by tests/performance/real_bodies_table.py --render"
        self.assertEqual(real_bodies_page.as_json(document), text, "docs/real_bodies.json")
        page = (ROOT / "docs/real_bodies.md").read_text(encoding="utf-8")
        self.assertEqual(real_bodies_page.page(document), page, f"docs/real_bodies.md: {remedy}")

    def test_tables_of_many_ranks_are_those_of_the_model(self):
        page = (ROOT / "docs/dual_operator.md").read_text(encoding="utf-8")
        tables = [performance_tables.pages_table(physics) for physics in ("membrane", "solid")]
        tables += [performance_tables.cluster_table(physics) for physics in ("membrane", "solid")]
        for table in (*tables, performance_tables.takeovers(), performance_tables.cluster_takeovers()):
            self.assertIn(table, page, "performance_model.py --tables prints what is to stand there")
        guide = (ROOT / "docs/clusters.md").read_text(encoding="utf-8")
        self.assertIn(performance_tables.guide_table(), guide, "the last one of performance_model.py --tables")
        self.assertIn(performance_tables.guide_words(), guide, "the sentence of performance_model.py --tables")

    def test_growth_of_products_is_that_of_the_model(self):
        page = (ROOT / "docs/dual_operator.md").read_text(encoding="utf-8")
        plane, space = performance_model.GROWTH.values()
        slender = performance_model.SLENDER.values()
        coefficients = "a = {} in the plane and {} in space, c = {} and {}".format(plane, space, *slender)
        self.assertIn(coefficients, page)
        header = (ROOT / "packages/feti/src/model/Harmos_ClusterModel.hpp").read_text(encoding="utf-8")
        self.assertIn(f"plane = {plane}, space = {space};", header)
        self.assertIn("slenderInPlane = {}, slenderInSpace = {};".format(*slender), header)

    def test_every_hard_case_has_its_row_and_its_test(self):
        """docs/stability.md has each test of tests/stability once, and no other.

        They are declared for 1, 2 and 4 ranks, and the page has figures measured by them.
        """
        text = (ROOT / "docs/stability.md").read_text(encoding="utf-8")
        entry = re.compile(r"^\* \*\*([^*]+)\*\*\s+\(`(\w+)`\)\n((?:  .+\n)+)", re.M)
        cases = entry.findall(text)
        directory = ROOT / "tests/stability"
        tests = [name for source in sorted(directory.glob("*.cpp"))
                 for name in re.findall(r"TEST\(Stability, (\w+)\)", source.read_text(encoding="utf-8"))]
        self.assertEqual(sorted(name for _, name, _ in cases), sorted(tests))
        for _, name, told in cases:
            parts = dict(re.findall(r"^  \* ([\w ]+): (.+(?:\n    .+)*)", told, re.M))
            self.assertEqual(list(parts), ["Without the remedy", "Remedy", "Measured"], name)
            self.assertRegex(parts["Measured"], r"\d", f"how it behaves, with a figure: {name}")
        declared = (directory / "CMakeLists.txt").read_text(encoding="utf-8")
        self.assertIn("RANKS 1 2 4", declared)
        for source in directory.glob("test_*.cpp"):
            self.assertRegex(declared, rf"(\b|_){source.stem[5:]}\b")

    def test_decks_that_are_named_exist(self):
        for page in ("docs/README.md", "docs/scenes.md", "docs/signorini.md", "docs/debonding.md",
                     "docs/accuracy.md", "docs/shape.md"):
            text = (ROOT / page).read_text(encoding="utf-8")
            for deck in re.findall(r"`(apps/[^`]*\.xml)`", text):
                self.assertTrue(list(ROOT.glob(deck)), deck)

    def test_readme_shows_the_result_of_its_deck(self):
        """The lines of summary.json that the README prints; numbers to six digits."""
        text = (ROOT / "README.md").read_text(encoding="utf-8")
        deck = re.search(r"build/bin/harmos (docs/examples/\w+\.yaml) --output run\n", text).group(1)
        printed = re.compile(r"```sh\ngrep -E '([^']*)' run/summary\.json\n```\n\nprints:\n\n```\n(.*?)```", re.S)
        pattern, shown = printed.search(text).groups()
        directory = runs.scratch()
        done = runs.start([ROOT / deck, "--output", directory], program="harmos")
        self.assertEqual(done.returncode, 0, done.stderr)
        summary = (directory / "summary.json").read_text(encoding="utf-8").splitlines()
        found = [line for line in summary if re.search(pattern, line)]
        self.assertEqual(len(found), len(shown.splitlines()), found)
        for line, wanted in zip(found, shown.splitlines()):
            (name, value), (key, expected) = (part.strip(" ,").split(": ") for part in (line, wanted))
            self.assertEqual(name, key)
            if value != expected:
                self.assertAlmostEqual(float(value) / float(expected), 1.0, 6, line)

    def test_constants_are_those_of_the_code(self):
        """A number before the comment `<!-- NAME in FILE -->`: that of the first `NAME = number` in the file."""
        marked = re.compile(r"(\d[\d.e+-]*)<!-- (\w+)\s+in\s+([\w/.]+)\s+-->")
        found = 0
        for page in pages():
            text = page.read_text(encoding="utf-8")
            self.assertEqual(len(marked.findall(text)), len(re.findall(r"<!-- \w+\s+in\s", text)), page)
            for number, name, file in marked.findall(text):
                with self.subTest(page=page.name, name=name):
                    code = (ROOT / file).read_text(encoding="utf-8")
                    constant = re.search(rf"\b{name} = (\d[\d.e+-]*)", code)
                    self.assertIsNotNone(constant, f"{file} has no constant {name}")
                    self.assertEqual(float(number), float(constant.group(1)), file)
                    found += 1
        self.assertGreater(found, 2)

    def test_every_deck_of_harmos_has_its_place_and_picture_in_the_guide(self):
        text = (ROOT / "docs/scenes.md").read_text(encoding="utf-8")
        decks = sorted((ROOT / "apps/harmos/decks").glob("*.xml"))
        self.assertTrue(decks)
        for deck in decks:
            self.assertIn(f"`{deck.name}`", text)
            picture = ROOT / f"docs/images/{deck.stem}.png"
            self.assertIn(f"](images/{picture.name})", text)
            self.assertLess(picture.stat().st_size, 150_000, picture)

    def test_every_deck_of_shape_has_its_place_and_picture_in_the_guide(self):
        text = (ROOT / "docs/shape.md").read_text(encoding="utf-8")
        decks = sorted((ROOT / "apps/shape/decks").glob("*.xml"))
        self.assertTrue(decks)
        for deck in decks:
            self.assertIn(f"apps/shape/decks/{deck.name}", text)
            self.assertIn(f"](images/shape_{deck.stem}.png)", text)
        for picture in (ROOT / "docs/images").glob("shape_*.png"):
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


class Commands(unittest.TestCase):
    """Those of longer pages."""

    run_pages, run_block, pictures_of = Documents.run_pages, Documents.run_block, staticmethod(Documents.pictures_of)

    def test_commands_run(self):
        self.run_pages("docs/signorini.md", "docs/debonding.md", "docs/shape.md")


if __name__ == "__main__":
    runs.main()
