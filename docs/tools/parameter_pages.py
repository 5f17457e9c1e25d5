#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The parameter reference, docs/parameters, from what the programs print.

    parameter_pages.py [BINARIES]      writes the pages; the programs are in build/bin or BINARIES

A page a program; and a page a kind of effect, so that a new effect brings a page of its own and changes
no other.
"""

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PLACE = "docs/parameters"
PROGRAMS = ("signorini", "harmos", "fiber_composite", "study", "shape")
EFFECTS_OF = "harmos"  # others that have effects have the same


def pages(program, printed):
    """What --print-parameters markdown printed as pages: their texts by path from the top."""
    own, of_effects = [], {}
    for section in re.split(r"(?m)^(?=## )", printed):
        kind = re.match(r"## \w+/Effects/([^/\n]+)", section)
        if kind and program == EFFECTS_OF:
            of_effects.setdefault(kind.group(1), []).append(section)
        elif kind:
            continue
        elif re.match(r"## \w+/Effects\n", section):
            own.append(section.rstrip("\n") + "\nEach kind has [a page of its own](effects).\n\n")
        else:
            own.append(section)
    result = {f"{PLACE}/{program}.md": "".join(own)}
    for kind, sections in of_effects.items():
        path = f"{PLACE}/effects/{kind.lower().replace(' ', '_')}.md"
        result[path] = f"# Parameters of the effect {kind}\n\n" + "".join(sections).rstrip("\n") + "\n"
    return result


def main():
    binaries = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "build/bin"
    for program in PROGRAMS:
        command = [str(binaries / program), "--print-parameters", "markdown"]
        printed = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        for path, text in pages(program, printed).items():
            (ROOT / path).parent.mkdir(exist_ok=True)
            (ROOT / path).write_text(text, encoding="utf-8")
            print(path)


if __name__ == "__main__":
    main()
