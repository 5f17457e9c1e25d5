# SPDX-License-Identifier: BSD-3-Clause
"""A million tetrahedra that no rank has whole.

What it guards against: a rank that holds more of a mesh than its own subdomains, when it is cut by harmos-mesh.
"""

import csv
import re
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))
sys.path.insert(0, str(Path(__file__).resolve().parent))

import harmos_runs as runs  # noqa: E402
import test_mesh_program as meshes  # noqa: E402

GEOMETRY = """
SetFactory("OpenCASCADE");
Box(1) = {{0, 0, 0, 1, 1, 1}};
Box(2) = {{0.2, 0.2, 1, 0.6, 0.6, 1}};
Physical Volume("lower") = {{1}};
Physical Volume("upper") = {{2}};
Mesh.MeshSizeMax = {size};
"""
SIZE, BODIES, SUBDOMAINS = 0.0175, ("lower", "upper"), (176, 64)
MOST = 1.3  # times the memory of another rank

DECK = """
<ParameterList name="harmos">
  <ParameterList name="Model">
    <Parameter name="Physics" type="string" value="solid"/>
    <Parameter name="Mesh file" type="string" value="mesh.h5"/>
  </ParameterList>
  <ParameterList name="Materials"><ParameterList name="soft"/></ParameterList>
  <ParameterList name="Bodies">
    <ParameterList name="lower"><Parameter name="Materials" type="Array(string)" value="{soft}"/></ParameterList>
    <ParameterList name="upper"><Parameter name="Materials" type="Array(string)" value="{soft}"/></ParameterList>
  </ParameterList>
  <ParameterList name="Boundary parts">
    <ParameterList name="under"><Parameter name="Normal" type="Array(double)" value="{0, 0, -1}"/></ParameterList>
    <ParameterList name="over"><Parameter name="Normal" type="Array(double)" value="{0, 0, 1}"/></ParameterList>
  </ParameterList>
  <ParameterList name="Effects">
    <ParameterList name="Contact">
      <ParameterList name="joint">
        <Parameter name="First" type="string" value="upper/under"/>
        <Parameter name="Second" type="string" value="lower/over"/>
      </ParameterList>
    </ParameterList>
    <ParameterList name="Prescribed displacement">
      <ParameterList name="ground"><Parameter name="Part" type="string" value="lower/under"/></ParameterList>
      <ParameterList name="press">
        <Parameter name="Part" type="string" value="upper/over"/>
        <Parameter name="Displacement" type="Array(double)" value="{0, 0, -0.01}"/>
      </ParameterList>
    </ParameterList>
  </ParameterList>
  <ParameterList name="Output">
    <Parameter name="Fields" type="bool" value="false"/>
    <ParameterList name="Expert">
      <Parameter name="Rank diagnostics" type="bool" value="true"/>
    </ParameterList>
  </ParameterList>
</ParameterList>
"""


# Peak of a rank of a program, MiB, as its parent sees it.
WATCHED = """
import os, resource, subprocess, sys
done = subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL)
peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
os.write(1, f"rank {os.environ['OMPI_COMM_WORLD_RANK']} peak {peak}\\n".encode())  # at once, or ranks' words mix
sys.exit(done.returncode)
"""


class LargeMesh(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.directory = runs.scratch("large")
        cls.directory.mkdir()
        (cls.directory / "mesh.geo").write_text(GEOMETRY.format(size=SIZE), encoding="utf-8")
        (cls.directory / "deck.xml").write_text(DECK, encoding="utf-8")
        cuts = [word for body, number in zip(BODIES, SUBDOMAINS) for word in ("--cut", f"{body}={number}")]
        done = meshes.mesh(cls.directory / "mesh.geo", "--output", cls.directory / "mesh.h5", *cuts)
        assert done.returncode == 0, done

    def checked(self, ranks, words=()):
        """Peak of each rank that reads the mesh, assembles and searches contacts."""
        deck = self.directory / "deck.xml"
        command = [*runs.launcher(ranks), sys.executable, "-c", WATCHED, runs.application("harmos"), deck, "--check", *words]
        status, printed, said = runs.execute(command)
        self.assertEqual(status, 0, said)
        peaks = dict(re.findall(r"rank (\d+) peak ([\d.]+)", printed))
        return [float(peaks[str(rank)]) for rank in range(ranks)]

    def test_set_up(self):
        rows = []
        for ranks in (2, 4):
            memory = self.checked(ranks)
            rows.append((f"mesh.h5, {ranks} ranks", *(f"{m:.0f}" for m in memory)))
            self.assertLessEqual(memory[0], MOST * min(memory[1:]))
        # The first rank reads and cuts a geometry by itself, and that is seen.
        words = ["--set", "Model/Mesh file=mesh.geo"]
        for body, number in zip(BODIES, SUBDOMAINS):
            words += ["--set", f"Bodies/{body}/Subdomains={number}"]
        memory = self.checked(4, words)
        rows.append(("mesh.geo, 4 ranks", *(f"{m:.0f}" for m in memory)))
        self.assertGreater(memory[0], 2 * MOST * min(memory[1:]))
        runs.table("Peak memory of each rank, MiB", ("mesh", "0", "1", "2", "3"),
                   [(*row, *[""] * (5 - len(row))) for row in rows])

    def test_solved(self):
        run = runs.solved(self, self.directory / "deck.xml", np=4, program="harmos")
        with open(run.directory / "ranks.csv", newline="", encoding="utf-8") as file:
            memory = [float(row["peak_memory_mib"]) for row in csv.DictReader(file)]
        runs.table("Peak memory of each rank, MiB", ("0", "1", "2", "3"), [[f"{m:.0f}" for m in memory]])
        self.assertLessEqual(memory[0], MOST * min(memory[1:]))


if __name__ == "__main__":
    runs.main()
