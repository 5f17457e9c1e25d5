# SPDX-License-Identifier: BSD-3-Clause
"""What it takes to cut a mesh compactly, beside METIS alone: the stage of meshes of harmos, without what follows.

    cutting.py [--cells 1000000] [--parts 24 384] [--repetitions 3] [--mesh FILE --body NAME] [--output JSON]

The mesh is a cube of tetrahedra, six in each small cube, written to a file of Gmsh's format 2, or any file with
a physical group NAME of its cells. A run reads, cuts and tears it; it is ended when it says that it has, before
it assembles anything. Seconds are those of the processor, which other programs on the machine hardly change; runs
with METIS and with compact parts are made in turns. Linux alone.
"""

import argparse
import array
import itertools
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "support")]

import harmos_measure  # noqa: E402
import harmos_runs as runs  # noqa: E402
from real_bodies import entry, group  # noqa: E402

PARTITIONS = ("METIS", "compact")


def write_cube(path, cells):
    """A cube of about so many tetrahedra (Kuhn: each small cube along its diagonal), as binary format 2.2."""
    n = max(1, round((cells / 6) ** (1 / 3)))
    side = n + 1
    nodes = bytearray()
    for number, (k, j, i) in enumerate(itertools.product(range(side), repeat=3), start=1):
        nodes += array.array("i", [number]).tobytes()
        nodes += array.array("d", [i / n, j / n, k / n]).tobytes()
    steps = (1, side, side * side)
    paths = []
    for order in itertools.permutations(range(3)):
        ends = list(itertools.accumulate((steps[d] for d in order), initial=0))
        even = order in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
        paths.append(ends if even else [ends[0], ends[2], ends[1], ends[3]])
    elements = array.array("i", [4, 6 * n**3, 2])  # tetrahedra, how many, tags of each
    number = 0
    for k, j, i in itertools.product(range(n), repeat=3):
        first = 1 + i + side * (j + side * k)
        for ends in paths:
            number += 1
            elements.extend([number, 1, 1, *(first + end for end in ends)])
    with open(path, "wb") as file:
        file.write(b"$MeshFormat\n2.2 1 8\n" + array.array("i", [1]).tobytes() + b"\n$EndMeshFormat\n")
        file.write(b'$PhysicalNames\n1\n3 1 "cube"\n$EndPhysicalNames\n')
        file.write(b"$Nodes\n%d\n" % side**3 + bytes(nodes) + b"\n$EndNodes\n")
        file.write(b"$Elements\n%d\n" % number + elements.tobytes() + b"\n$EndElements\n")


def write_deck(path, mesh, body):
    material = group("elastic", entry("Young's modulus", "double", 1))
    weight = group("weight", entry("Body", "string", body), entry("Density", "Array(double)", "{0, 0, -1}"))
    model = (entry("Physics", "string", "solid"), entry("Mesh file", "string", mesh))
    path.write_text(
        group(
            "harmos",
            group("Model", *model),
            group("Materials", material),
            group("Bodies", group(body, entry("Materials", "Array(string)", "{elastic}"))),
            group("Effects", group("Body force", weight)),
        ),
        encoding="utf-8",
    )


def processor_seconds(process):
    """Of all its threads, so far."""
    fields = Path(f"/proc/{process.pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def seconds_of(deck, body, parts, partition):
    """From the line that announces the mesh file to the one that says how it was cut; and the cells.

    @throws RunFailed if there is no such line.
    """
    command = [runs.application("harmos"), deck]
    for name, value in {"Subdomains": parts, "Expert/Partition": partition}.items():
        command += ["--set", f"Bodies/{body}/{name}={value}"]
    command += ["--output", runs.scratch()]
    process = subprocess.Popen(
        [str(word) for word in command],
        env=runs.environment(),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    begin, lines = None, []
    try:
        for line in process.stdout:
            lines.append(line)
            if line.startswith("Reading the mesh file"):
                begin = processor_seconds(process)
            cut = re.match(rf'Body "{re.escape(body)}": .* (\d+) cells .*, cut into ', line)
            if cut:
                return processor_seconds(process) - begin, int(cut.group(1))
    finally:
        process.kill()
        process.communicate()
    raise harmos_measure.RunFailed("".join(lines))


def measured(deck, body, parts, given):
    """An entry of the JSON."""
    seconds = {partition: [] for partition in PARTITIONS}
    for _ in range(given.repetitions):
        for partition in PARTITIONS:
            taken, cells = seconds_of(deck, body, parts, partition)
            seconds[partition].append(taken)
            print(cells, "cells", parts, "parts", partition, f"{taken:.2f} s", flush=True)
    pairs = zip(seconds["METIS"], seconds["compact"])
    return {
        "cells": cells,
        "parts": parts,
        "metis_seconds": statistics.median(seconds["METIS"]),
        "compact_seconds": statistics.median(seconds["compact"]),
        "more_seconds": statistics.median(compact - metis for metis, compact in pairs),
    }


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--cells", type=int, default=1000000)
    parser.add_argument("--parts", nargs="+", type=int, default=[24, 384])
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--mesh", help="a mesh file, in the place of the cube")
    parser.add_argument("--body", default="cube", help="the group of its cells")
    parser.add_argument("--output")
    given = parser.parse_args()
    document = {
        "benchmark": "cutting",
        "harmos": harmos_measure.version(),
        "ranks": 1,
        "mesh": given.mesh or "cube",
        "runs": [],
    }
    with tempfile.TemporaryDirectory() as directory:
        mesh = given.mesh
        if not mesh:
            mesh = Path(directory) / "cube.msh"
            write_cube(mesh, given.cells)
        deck = Path(directory) / "cut.xml"
        write_deck(deck, Path(mesh).resolve(), given.body)
        for parts in given.parts:
            document["runs"].append(measured(deck, given.body, parts, given))
    for item in document["runs"]:
        print(
            f"{item['parts']} parts: METIS {item['metis_seconds']:.2f} s, compact {item['compact_seconds']:.2f} s, "
            f"{item['more_seconds']:.2f} s more"
        )
    if given.output:
        Path(given.output).write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
