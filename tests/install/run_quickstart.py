# SPDX-License-Identifier: BSD-3-Clause
"""docs/quickstart.md does what it says: its commands, run as they stand there, end in its pictures.

    run_quickstart.py                     what follows the build, with the build there is: seconds
    run_quickstart.py --chroot DIRECTORY  all of it, in a bare Debian that is made in DIRECTORY
    run_quickstart.py --refresh           draw the page's pictures anew, with the build there is

The blocks of shell commands are taken literally from the page and run in order by one shell, which
starts in a fresh directory. Two replacements are made: URL by the path of the repository; and,
with the build that there is, the first block by `cmake/bootstrap.sh show`, the end of what it does,
in a directory of links to the sources and to the build. Then all of it again with what the page's
section on installing has installed, in a directory without sources. --chroot needs root and debootstrap (see
cmake/test_in_chroot.sh) and takes about as long as a build; CI does not use it.

Guards against commands that no longer work, or only where their author sat or the sources lie;
pictures that are not those of the commands; output that differs from what the page shows.
"""

import argparse
import os
import re
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402

try:
    import numpy as np
    from PIL import Image
except ImportError as missing:
    runs.skip(f"the Python module {missing.name} is missing")

PAGE = runs.SOURCE / "docs" / "quickstart.md"
BUILD_COMMAND = "cmake/bootstrap.sh run"
INSTALL_COMMAND = "cmake --install build"

# What the page's section on installing says of its other commands.
SHARE = "~/.local/share/harmos"
INSTALLED = (
    (r"\bbuild/bin/", ""),
    (r"\bapps/(\w+)/decks/", rf"{SHARE}/decks/\1/"),
    (r"\bcmake/environment\.sh", f"{SHARE}/environment.sh"),
)
# The end of what cmake/bootstrap.sh run does.
SHOW = """mpirun -np 2 build/bin/signorini apps/signorini/decks/model.xml --output run
build/bin/harmos-plot run
"""

# Two pictures of one size are compared by the means of their squares of BLOCK x BLOCK pixels, for
# each colour, from 0 to 1. Right ones differ by
#   PALETTE: the page's have 256 colours, mixed; --refresh measures what that costs, refuses more;
#   1 / BLOCK: the solution is right to the decks' 1e-4, less than a pixel of 2000, but drawing
#       rounds axes to whole pixels: a line one pixel aside fills or leaves a row of a square.
# Pictures of other runs differ by more (Measure below). The caption is left out: it has the commit.
BLOCK = 16
PALETTE = 0.025
TOLERANCE = PALETTE + 1 / BLOCK
# Up to three lines of 8 points, at 150 dots an inch, above a margin (apps/tools/plot_style.py).
CAPTION = 3 * 20 + 15

# Energies are right to the square of the decks' 1e-4, times the condition of the dual problem, for
# which 100 is allowed.
DIGITS = 1e-6

SHELL = re.compile(r"```sh\n(.*?)```", re.S)
PICTURE = re.compile(r"`([\w-]+/\w+\.png)`:\n\n!\[[^\]]*\]\((images/\w+\.png)\)")
FIGURE = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])")
PRINTED = re.compile(r"```sh\n([^`]*)```\n\nprints:\n\n```\n(.*?)```", re.S)


def blocks():
    found = SHELL.findall(PAGE.read_text(encoding="utf-8"))
    if not found[0].endswith(BUILD_COMMAND + "\n"):
        raise AssertionError(f"the first block of {PAGE} does not end in {BUILD_COMMAND}")
    return found


def pictures():
    """What the commands make, below the checkout, and the picture of the page that shows it."""
    found = PICTURE.findall(PAGE.read_text(encoding="utf-8"))
    return {made: PAGE.parent / shown for made, shown in found}


def pixels(path):
    return np.asarray(Image.open(path).convert("RGB"), dtype=float) / 255


def means(image):
    rows, columns = (size // BLOCK for size in image.shape[:2])
    cut = image[: rows * BLOCK, : columns * BLOCK]
    return cut.reshape(rows, BLOCK, columns, BLOCK, 3).mean(axis=(1, 3))


def difference(first, second):
    """The measure, of pictures of one size without their captions."""
    first, second = (means(image[: len(image) - CAPTION]) for image in (first, second))
    return float(abs(first - second).max())


def by_a_stranger(directory, *commands):
    """Run by a shell that knows nothing of this test, at home in a directory; what was printed."""
    environment = [f"PATH={os.environ['PATH']}", f"HOME={directory}"]
    command = ["env", "-i", *environment, "bash", "-euc", "".join(commands)]
    return runs.execute(command, cwd=directory)


def in_links():
    """Run what follows the build; the checkout of links, and what was printed."""
    directory = runs.scratch("stranger")
    checkout = directory / "harmos"
    checkout.mkdir(parents=True)
    for entry in ("apps", "cmake", "docs"):
        (checkout / entry).symlink_to(runs.SOURCE / entry)
    (checkout / "build").symlink_to(runs.BINARY)
    begin = "cd harmos\ncmake/bootstrap.sh show\n"
    return checkout, by_a_stranger(directory, begin, *blocks()[1:])


def installed():
    """Install as the page says, run the other blocks as it says for that; where, what was printed."""
    (install,) = (block for block in blocks() if INSTALL_COMMAND in block)
    others = "".join([SHOW, *(block for block in blocks()[1:] if block != install)])
    for here, there in INSTALLED:
        others = re.sub(here, there, others)
    directory = runs.scratch("elsewhere")
    directory.mkdir()
    (directory / "build").symlink_to(runs.BINARY)
    # Nothing but what is installed is left.
    begin = install + "rm build\n" + f". {SHARE}/environment.sh\n"
    return directory, by_a_stranger(directory, begin, others)


def in_chroot(root, suite):
    """Run the whole page; the checkout, and what was printed."""
    checkout = root / "root" / "harmos"
    if checkout.exists():
        sys.exit(f"{root} is not bare, it holds {checkout}: name another directory")
    script = "".join(blocks()).replace(" URL ", " /srv/harmos.git ")
    enter = [runs.SOURCE / "cmake" / "test_in_chroot.sh", "--bare", suite, root]
    subprocess.run([*enter, "true"], check=True)
    begin = time.time()
    lines = []
    command = [*enter, "bash", "-euc", script]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        for line in process.stdout:
            print(line, end="", flush=True)
            lines.append(line)
    print(f"{time.time() - begin:.0f} s from a bare {suite} to the last picture", flush=True)
    return checkout, (process.returncode, "".join(lines), "")


class Quickstart(unittest.TestCase):
    trial = staticmethod(in_links)

    @classmethod
    def setUpClass(cls):
        cls.checkout, (status, cls.printed, errors) = cls.trial()
        if status != 0:
            raise AssertionError(f"exit status {status}\n{cls.printed}{errors}")

    def test_commands_make_the_pictures_of_the_page(self):
        self.assertGreaterEqual(len(pictures()), 4)
        for made, shown in pictures().items():
            with self.subTest(picture=made):
                first, second = pixels(self.checkout / made), pixels(shown)
                self.assertEqual(first.shape, second.shape)
                off = difference(first, second)
                print(f"{made}: {off:.3f} of {TOLERANCE:.3f}", flush=True)
                self.assertLess(off, TOLERANCE)

    def test_every_picture_of_the_page_is_made(self):
        images = re.findall(r"\]\((images/[^)]+)\)", PAGE.read_text(encoding="utf-8"))
        self.assertEqual(sorted(images), sorted(f"images/{p.name}" for p in pictures().values()))

    def test_commands_print_what_the_page_shows(self):
        """Words literally, figures to DIGITS."""
        found = PRINTED.findall(PAGE.read_text(encoding="utf-8"))
        self.assertTrue(found)
        for _, shown in found:
            pattern = r"(\S+)".join(map(re.escape, FIGURE.split(shown)))
            printed = re.search(pattern, self.printed)
            self.assertTrue(printed, f"{shown}\nis not in\n{self.printed}")
            for first, second in zip(FIGURE.findall(shown), printed.groups()):
                self.assertLessEqual(abs(float(first) - float(second)), DIGITS * abs(float(first)))


class QuickstartInstalled(Quickstart):
    trial = staticmethod(installed)

    def test_nothing_is_taken_from_elsewhere(self):
        self.assertFalse((self.checkout / "build").exists())
        for command in ("signorini", "harmos", "harmos-plot"):
            self.assertTrue((self.checkout / ".local" / "bin" / command).exists(), command)


class Measure(unittest.TestCase):
    """Pictures of other runs are told from those of the page."""

    def test_other_pictures_of_the_same_size(self):
        for shown in pictures().values():
            right = pixels(shown)
            white = np.ones_like(right)
            with self.subTest(picture=shown.name):
                self.assertGreater(difference(right, white), 2 * TOLERANCE)
                self.assertGreater(difference(right, right[:, ::-1]), 2 * TOLERANCE)
                self.assertEqual(difference(right, right), 0.0)

    def test_runs_that_differ_in_a_parameter(self):
        """The same model, cut into fewer subdomains: the solution is the same, lines are not."""
        run = runs.solved(self, runs.MODEL, {"Model/Subdomains per side": 2})
        status, _, errors = runs.execute(
            [sys.executable, runs.application("harmos-plot"), run.directory]
        )
        self.assertEqual(status, 0, errors)
        for made, shown in pictures().items():
            if made.startswith("run/"):
                first, second = pixels(run.directory / Path(made).name), pixels(shown)
                self.assertEqual(first.shape, second.shape)
                self.assertGreater(difference(first, second), TOLERANCE)


def refresh():
    checkout, (status, printed, errors) = in_links()
    if status != 0:
        sys.exit(f"exit status {status}\n{printed}{errors}")
    for made, shown in pictures().items():
        image = Image.open(checkout / made).convert("RGB")
        palette = image.quantize(256, method=Image.MAXCOVERAGE)
        image.quantize(palette=palette, dither=Image.FLOYDSTEINBERG).save(shown, optimize=True)
        off = difference(pixels(checkout / made), pixels(shown))
        print(f"{shown}: {shown.stat().st_size} bytes, a square is off by {off:.3f}")
        if off > PALETTE:
            sys.exit(f"{shown}: 256 colours are too few, a square may be off by {PALETTE}")
    print(printed)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--chroot", type=Path, metavar="DIRECTORY")
    parser.add_argument("--suite", default="bookworm", help="release of Debian (default: bookworm)")
    parser.add_argument("--refresh", action="store_true")
    options, words = parser.parse_known_args()
    sys.argv[1:] = words
    if options.refresh:
        refresh()
    else:
        if options.chroot:
            root = options.chroot.resolve()
            Quickstart.trial = staticmethod(lambda: in_chroot(root, options.suite))
        runs.main()
