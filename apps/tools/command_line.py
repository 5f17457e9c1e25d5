# SPDX-License-Identifier: BSD-3-Clause
"""What harmos-plot and harmos-study-plot share: options, and sentences for what cannot be drawn.

Needs Python's standard library alone, so that --help works where nothing can be drawn.
"""

import argparse
import importlib
import sys
from pathlib import Path

NEEDED = ("numpy", "matplotlib")  # h5py only where there are fields, see run_results.py; VTK in vtk_scene.py
PACKAGES = {"vtkmodules": "python3-vtk9"}  # the others are called as their modules


class PlotError(Exception):
    """Input that cannot be drawn; the message says what, where and how to mend it."""


def missing(module, error):
    """What to do where a module cannot be imported."""
    reason = " ".join(str(error).split())
    return (
        f"{sys.executable} cannot import {module} ({reason}): install Debian's package "
        f"{PACKAGES.get(module, f'python3-{module}')} for /usr/bin/python3, or use an interpreter that has it, as in "
        f"PYTHON {sys.argv[0]} DIR"
    )


def within(low, high):
    """Of an option: a number in this range."""

    def number(text):
        value = float(text)
        if not low <= value <= high:
            raise argparse.ArgumentTypeError(f"{text} is out of range; choose {low:g} to {high:g}")
        return value

    return number


def parser_of(text, directory, dpi):
    """Of a tool whose --help begins with this text: the options of all pictures."""
    parser = argparse.ArgumentParser(
        description=text, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("directory", metavar="DIR", help=directory)
    parser.add_argument("--output", metavar="DIR2", help="directory for the pictures (default: DIR)")
    parser.add_argument(
        "--dpi", type=within(10, 1200), default=dpi, help=f"dots per inch (default: {dpi})"
    )
    parser.add_argument("--title", default="", help="title of the pictures (default: none)")
    return parser


def draw(module, options):
    """Calls run(options) of a module that draws; the exit status."""
    name = Path(sys.argv[0]).name
    for needed in NEEDED:
        try:
            importlib.import_module(needed)
        except ImportError as error:
            print(f"{name}: {missing(needed, error)}", file=sys.stderr)
            return 2
    options.title = options.title.replace("$", r"\$")  # no formula
    try:
        importlib.import_module(module).run(options)
    except KeyboardInterrupt:
        return 130
    except PlotError as error:
        print(f"{name}: {error}", file=sys.stderr)
        return 2
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        # Files that can be read and hold something else: each may lack anything.
        fault = " ".join(f"{type(error).__name__}: {error}".split())
        print(
            f"{name}: {options.directory}: the files are not the output of a finished run "
            f"({fault}); repeat the run",
            file=sys.stderr,
        )
        return 2
    return 0
