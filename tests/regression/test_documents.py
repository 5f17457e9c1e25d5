# SPDX-License-Identifier: BSD-3-Clause
"""The documentation says what is true.

Guards against a parameter page that was not generated anew, links that lead nowhere, commands in the
README that no longer work, and examples that differ from what their page shows.
"""

import pathlib
import re
import shlex
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import harmos_runs as runs  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Documents(unittest.TestCase):
    def test_parameter_page_is_what_the_program_prints(self):
        printed = runs.start(["--print-parameters", "markdown"], np=1)
        self.assertEqual(printed.returncode, 0, printed.stderr)
        page = (ROOT / "docs/parameters/signorini.md").read_text(encoding="utf-8")
        self.assertEqual(
            page, printed.stdout,
            "generate it: build/bin/signorini --print-parameters markdown > docs/parameters/signorini.md")

    def test_links_lead_somewhere(self):
        for page in [ROOT / "README.md", *ROOT.glob("docs/**/*.md"), *ROOT.glob("packages/*/README.md")]:
            text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.S)
            for target in re.findall(r"\]\(([^)#]+)\)", text):
                if "://" not in target:
                    self.assertTrue((page.parent / target).exists(), f"{page}: {target}")

    def test_readme_commands_run(self):
        """The block that runs a deck, word by word, with its output directory moved."""
        text = (ROOT / "README.md").read_text(encoding="utf-8")
        block = next(b for b in re.findall(r"```sh\n(.*?)```", text, re.S) if "mpirun" in b)
        words = shlex.split(block.replace("\\\n", " ").splitlines()[0])
        self.assertEqual(words[:4], ["mpirun", "-np", "2", "build/bin/signorini"])
        directory = runs.scratch()
        arguments = [str(directory) if w == "run" else w for w in words[4:]]
        arguments[0] = str(ROOT / arguments[0])
        done = runs.start(arguments, np=2)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue((pathlib.Path(directory) / "summary.json").exists())

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

    def test_decks_of_the_readme_exist(self):
        text = (ROOT / "README.md").read_text(encoding="utf-8")
        for deck in re.findall(r"`(apps/[^`]*\.xml)`", text):
            self.assertTrue((ROOT / deck).exists(), deck)


if __name__ == "__main__":
    runs.main()
