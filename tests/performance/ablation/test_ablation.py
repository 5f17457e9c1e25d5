#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The ablation's knobs are those of the sources, and its table says what its lines say.

    Knobs     a rescue or a number whose text has changed, a constant that is no knob
    Table     scenes that are lost, won or differ; ratios of those that converge both ways; the page
"""

import shutil
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "support")]

import ablation  # noqa: E402
import harmos_runs as runs  # noqa: E402
import knobs  # noqa: E402


class Knobs(unittest.TestCase):
    def test_all_have_their_place(self):
        with tempfile.TemporaryDirectory() as place:
            shutil.copytree(runs.SOURCE / knobs.PACKAGE, Path(place) / knobs.PACKAGE)
            trials = knobs.planted(Path(place))
            for name, values in trials.items():
                self.assertTrue(values, name)
                self.assertEqual(len(values), len(set(values)), name)
            texts = "".join(path.read_text(encoding="utf-8") for path in Path(place).rglob("*.[hc]pp"))
            self.assertFalse([name for name in trials if f'"{name}"' not in texts])
        self.assertLessEqual({place.knob for place in knobs.RESCUES + knobs.NUMBERS}, set(trials))

    def test_constants(self):
        text = (
            "class A {\n  static constexpr int most = 3, least = 1;\n};\n"
            "void f() {\n  constexpr double share = 0.25, other = 1e-3;\n"
            "  constexpr double unmoved = std::numeric_limits<double>::max();\n"
            "  constexpr std::size_t block = 512;\n}\n"
        )
        planted, trials = knobs.constants("Harmos_A.hpp", text)
        self.assertEqual(
            trials,
            {"A.most": [9.0, 1], "A.least": [3.0], "A.share": [0.75, 0.25 / 3], "A.other": [3e-3, 1e-3 / 3]},
        )
        self.assertIn('static inline const ::Harmos::tuning::Constant<int> most{"A.most", 3}, least{"A.least", 1};', planted)
        self.assertIn('const double share = HARMOS_TUNED("A.share", 0.25), other = HARMOS_TUNED("A.other", 1e-3);', planted)
        self.assertIn("constexpr double unmoved", planted)
        self.assertIn("constexpr std::size_t block = 512;", planted)


def line(scene, applications, converged=True, **more):
    return {"family": "random", "scene": scene, "converged": converged, "applications": applications, **more}


class Table(unittest.TestCase):
    NONE = {"solvable": False, "reason": "infeasible: no x"}
    LINES = [
        line(0, 10), line(1, 20, energy=-1.0), line(2, 30, False), line(3, 40), line(4, 50), line(5, 7, False, **NONE),
        line(6, 8, False, **NONE),
        *(line(scene, count, converged, knob="off: a", value=1.0)
          for scene, count, converged in ((0, 10, True), (2, 30, True), (3, 99, False))),
        line(1, 30, energy=-1.1, knob="off: a", value=1.0),
        line(5, 7, False, knob="off: a", value=1.0, solvable=False, reason="iteration limit"),
        line(6, 8, True, knob="off: a", value=1.0, solvable=False),
        line(0, 10, knob="b", value=3.0),
        {"family": "random", "scene": 0, "complete": ["b", "off: a"]},
    ]

    def test_rows(self):
        table = ablation.table_of(self.LINES)
        self.assertEqual(table["families"]["random"], {"scenes": 7, "converged": 4, "good": 6, "median": 30.0, "share_95": 50, "largest": 50})
        first = table["rows"][1]
        self.assertEqual({key: first[key] for key in ("knob", "asked", "differ", "lost", "won", "wrong")},
                         {"knob": "off: a", "asked": 6, "differ": 5, "lost": 3, "won": 1, "wrong": 2})
        self.assertEqual((first["median"], first["largest"], first["total"]), (1.25, 1.5, 1.333))

    def test_page(self):
        text = ablation.text_of({**ablation.table_of(self.LINES), "knobs": ["b", "c", "off: a"]})
        self.assertIn("| a | off | random | 6 | 5 | 3 | 1 | 2 | 1.25 | 1.5 | 1.5 | 1.333 |", text)
        self.assertIn("no scene came to another count: b.", text)
        self.assertIn("Never asked for: c.", text)


if __name__ == "__main__":
    runs.main()
