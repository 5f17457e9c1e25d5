# SPDX-License-Identifier: BSD-3-Clause
"""Random interfaces under a uniform pressure: none of them shows, whatever elements, sides, parts and effects.

    test_interfaces.py [Blocks|Slits]      HARMOS_SCENES: how many; HARMOS_FIRST_SCENE: from which on

No answer with exit status 0 may be wrong: displacements, the pressure at each point of a contact, the force of each
interface. It guards against nodes that two effects hold, normals averaged over an edge, areas of sides that touch
nothing, nodes of both surfaces, and pressures of six-node triangles by areas that are none.
"""

import os
import sys
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "support"), str(HERE.parents[2] / "apps" / "tools")]

import harmos_decks  # noqa: E402
import harmos_runs as runs  # noqa: E402
import pressed_blocks  # noqa: E402
import pressed_slits  # noqa: E402

FIRST, SCENES = int(os.environ.get("HARMOS_FIRST_SCENE", "0")), int(os.environ.get("HARMOS_SCENES", "12"))
# Solved to 1e-10; ten times that, and a factor of a thousand by which forces at single nodes are worse than the norm of
# all: condition of local problems and constraints.
ALLOWED = 1e-6
# An interface of one facet between others has no node of its own.
NO_NODE = "and none is left that could carry a force"


def errors_of(scene, run):
    """What differs from the exact answer, relative; names of what is wrong."""
    import numpy as np
    import run_results

    result = run_results.read_result(run.directory / "result.vtkhdf")
    exact = scene.displacement(result.xyz)
    found = {"displacement": np.abs(result.displacement - exact).max() / np.abs(exact).max()}
    for name, area in scene.areas.items():
        force = run.summary["forces"][name]["force"]
        wanted = scene.force(name) * area
        found[name] = max(abs(f - (wanted if d == scene.up else 0.0)) for d, f in enumerate(force)) / abs(wanted)
    closed = result.active == 2
    if scene.hasPressure:
        found["pressure"] = (
            np.abs(result.pressure[closed] / pressed_blocks.PRESSURE - 1.0).max() if closed.any() else 1.0
        )
    return found


class Pressed:
    def scene(self, seed, directory):
        raise NotImplementedError

    def test_scenes(self):
        worst, rejected = 0.0, 0
        for seed in range(FIRST, FIRST + SCENES):
            directory = runs.scratch("pressed")
            directory.mkdir(parents=True, exist_ok=True)
            scene = self.scene(seed, directory)
            deck = directory / "deck.xml"
            deck.write_text(harmos_decks.xml("harmos", scene.tree()), encoding="utf-8")
            run = runs.run(deck, np=1 + seed % 2, output=directory / "out", program="harmos")
            with self.subTest(seed=seed, scene="; ".join(scene.words)):
                if run.returncode == 2 and NO_NODE in run.stderr:
                    rejected += 1
                    continue
                self.assertEqual(run.returncode, 0, run)
                errors = errors_of(scene, run)
                worst = max(worst, *errors.values())
                self.assertLess(max(errors.values()), ALLOWED, errors)
        self.assertLessEqual(rejected, 1 + SCENES // 50, "so many have an interface of a facet between others")
        print(f"{SCENES} scenes from {FIRST} on, {rejected} rejected: the worst is {worst:.1e}, {ALLOWED:.0e} is allowed")


class Blocks(Pressed, unittest.TestCase):
    def scene(self, seed, directory):
        return pressed_blocks.Blocks(seed)


class Slits(Pressed, unittest.TestCase):
    def scene(self, seed, directory):
        scene = pressed_slits.Slits(seed)
        scene.write_mesh(directory / "slit.msh")
        return scene


if __name__ == "__main__":
    runs.main()
