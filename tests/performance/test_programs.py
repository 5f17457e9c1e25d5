# SPDX-License-Identifier: BSD-3-Clause
"""The performance programs run, write what their README says, and converge. No time is judged.

    test_programs.py [Programs|Sweeps]     Sweeps is long

Guards against: a benchmark that rots; a document whose fields are not those described; counts that
grow with the mesh where the users' guide says that they do not.
"""

import argparse
import json
import re
import sys
import unittest
import unittest.mock
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE / "peer"), str(HERE / "messages"), str(HERE / "local"), str(HERE.parent / "support")]

import communication  # noqa: E402
import gmsh_meshes  # noqa: E402
import harmos_runs as runs  # noqa: E402
import headline  # noqa: E402
import headline_page  # noqa: E402
import local_solvers  # noqa: E402
import peer_petsc  # noqa: E402
import real_bodies_page  # noqa: E402
import unstructured_page  # noqa: E402

README = HERE / "README.md"


def run(program, *arguments, np=2):
    output = runs.scratch(program)
    binary = runs.BINARY / "tests/bin" / program
    status, _, errors = runs.execute([*runs.launcher(np), binary, *arguments, "--output", output])
    assert status == 0, errors
    return json.loads(output.read_text(encoding="utf-8"))


def described(program):
    """Fields of a run that the README's table or list names."""
    section = README.read_text(encoding="utf-8").split(f"## {program}\n")[1].split("\n## ")[0]
    names = set()
    for row in re.findall(r"^(?:\| |\* )((?:`[^`]*`,?\s*)+)(?:\||:)", section, re.M):
        names.update(re.findall(r"`([^`]*)`", row))
    return names


class Scripts(unittest.TestCase):
    def script(self, name, *arguments, statuses=(0,)):
        output = runs.scratch(Path(name).stem)
        words = [sys.executable, HERE / name, *arguments, "--output", output]
        status, _, errors = runs.execute(words)
        self.assertIn(status, statuses, errors)
        return json.loads(output.read_text(encoding="utf-8"))


class Programs(Scripts):
    def test_qp_kernels(self):
        document = run("qp_kernels", "--sizes", "1000,10000", "--repetitions", "1")
        self.assertEqual([r["entries"] for r in document["runs"]], [1000, 10000])
        for item in document["runs"]:
            self.assertEqual(set(item), described("qp_kernels"))
            self.assertTrue(item["results_agree"])
            self.assertGreater(item["fused_seconds"], 0)

    def test_journal_bearing(self):
        document = run("journal_bearing", "--sizes", "64,128", "--repetitions", "1")
        counts = []
        for item in document["runs"]:
            self.assertEqual(set(item) - {"n"}, described("journal_bearing"))
            finest = item["levels"][-1]
            self.assertEqual((finest["n"], finest["method"]), (item["n"], "PDAS"))
            for level in item["levels"]:
                self.assertEqual(level["reason"], "converged")
            self.assertLessEqual(finest["relative_projected_gradient"], 1e-6)
            counts.append(finest["hessian_applications"])
        # The bracket of the users' guide: 1.5 from one mesh to others.
        self.assertLessEqual(counts[1], 1.5 * counts[0])

    def test_dual_operator(self):
        document = run("dual_operator", "--subdomains", "2", "--sizes", "8", "--repetitions", "1")
        # Two forms, shared or not, two precisions.
        self.assertEqual(len(document["runs"]), 8)
        self.assertGreater(document["stream_gigabytes_per_second"], 0)
        for item in document["runs"]:
            self.assertEqual(set(item), described("dual_operator"))
            self.assertEqual(item["factorizations"], 3 if item["shared"] else 8)

    def test_cluster_growth(self):
        output = runs.scratch("cluster_growth")
        program = HERE / "clusters" / "cluster_growth.py"
        words = ("--plane", "1,2", "--space", "1,2", "--output", output)
        status, _, errors = runs.execute([sys.executable, program, *words])
        self.assertEqual(status, 0, errors)
        document = json.loads(output.read_text(encoding="utf-8"))
        motions = {"membrane": 1, "plane strain": 3, "solid": 6}
        for item in document["runs"]:
            clusters = 27 if item["physics"] == "solid" else 16
            self.assertEqual(item["clusters"]["coarse_dimension"], clusters * motions[item["physics"]], item)
            # Of a tolerance of 1e-8 energies know the square, and rounding errors.
            self.assertLess(item["difference"], 1e-10, item)
            # What the guide says: up to twice the products for 16 subdomains in the plane and 8 in space.
            self.assertLessEqual(item["clusters"]["products"], 2 * item["none"]["products"], item)
            if item["side"] > 1:
                self.assertGreater(item["clusters"]["products"], item["none"]["products"], item)
        self.assertEqual(set(document["fits"]), set(motions))
        self.assertEqual([item["shape"] for item in document["shapes"]], ["cubes", "plates", "bars"])

    def test_linear_limit(self):
        document = run("linear_limit", "--subdomains", "4", "--sizes", "8", "--repetitions", "1")
        self.assertEqual([r["contact"] for r in document["runs"]], ["closed", "open"])
        for item in document["runs"]:
            self.assertEqual(set(item), described("linear_limit"))
            self.assertTrue(item["converged"])
            self.assertLessEqual(item["products"], 1.1 * item["linear_products"] + 1)

    def test_load_steps(self):
        document = run("load_steps", "--subdomains", "4", "--elements", "8")
        for item in document["runs"]:
            self.assertEqual(set(item), described("load_steps"))
            self.assertTrue(item["converged"])
            self.assertEqual(item["steps"], 100)
            self.assertEqual(item["later_factorizations"], 0)
            self.assertLessEqual(item["step_products"], 0.5 * item["cold_step_products"])

    def test_coarse_factor(self):
        document = run("coarse_factor", "--sides", "8,16", np=0)
        for item, order in zip(document["runs"], (64, 256)):
            self.assertEqual(set(item), described("coarse_factor"))
            self.assertEqual(item["order"], order)
            self.assertEqual(item["distributed"]["form"], "rows")

    def test_contact_search(self):
        document = run("contact_search", "--side", "1", "--elements", "6", np=4)
        for item in document["runs"]:
            self.assertEqual(set(item), described("contact_search"))
            self.assertEqual(item["facets"], 2 * 6**2 + 2 * 7**2)
            self.assertEqual(item["facets_of_rank"], 7**2)
            # Nodes of the lower surface; the rank with the most has all of its own.
            self.assertEqual(item["rows"], 13 * 7)
            self.assertEqual(item["points_of_rank"], 7**2)

    def test_communication(self):
        document = self.script("messages/communication.py", "--ranks", "2,4")
        self.assertEqual(len(document["runs"]), 2 * 2 * 2 * 2)
        kinds = {f"{kind}_{key}" for kind in ("message", *communication.COLLECTIVES) for key in ("calls", "bytes")}
        counted = {f"{kind}_{when}" for kind in kinds for when in ("a_step", "of_setup")}
        for item in document["runs"]:
            self.assertEqual(set(item) - counted, described("communication"))
            # What a step says is what the model says, byte by byte; the end of a run has a number more or less.
            self.assertEqual(item["message_calls_a_step"], item["model_messages"])
            self.assertEqual(item["message_bytes_a_step"], item["model_message_bytes"])
            self.assertEqual(item["allgather_calls_a_step"], item["model_gathers"])
            self.assertAlmostEqual(item["allreduce_calls_a_step"], item["model_reductions"], delta=0.99)
            self.assertAlmostEqual(item["collective_bytes_a_step"], item["model_collective_bytes"], delta=50)
            self.assertEqual(item["broadcast_calls_a_step"], 0)

    def test_model_problem(self):
        document = self.script(
            "model_problem.py", "--cells", "2x8", "--kinds", "shared,unshared,tied", "--repetitions", "1"
        )
        shared, unshared, tied = document["runs"]
        self.assertEqual((shared["factorizations"], unshared["factorizations"]), (3, 8))
        self.assertEqual(tied["solver"], "PCPG")
        self.assertLess(abs(shared["energy"] - unshared["energy"]), 1e-4)

    def test_local_solvers(self):
        """Every solver that the page compares, on eight subdomains of a cube."""
        document = self.script("local/local_solvers.py", "--only", "cube", "--scale", "3", "--repetitions", "1")
        rows = document["scenes"]["cube"]
        self.assertEqual({item["solver"] for item in rows}, set(local_solvers.SOLVERS))
        for item in rows:
            self.assertEqual(item["local_solver"], item["solver"])

    def test_local_solvers_page(self):
        document = json.loads((runs.SOURCE / "docs/local_solvers.json").read_text(encoding="utf-8"))
        page = (runs.SOURCE / "docs/dual_operator.md").read_text(encoding="utf-8")
        self.assertIn(local_solvers.table(document["scenes"]), page)

    def test_headline(self):
        """Tiny forms of all cases converge; page and README can be written from the JSON."""
        page = runs.scratch("page")
        document = self.script("headline.py", "--quick", "--page", page)
        self.assertTrue(document["quick"])
        self.assertEqual([item["name"] for item in document["runs"]], list(headline.CASES))
        for item in document["runs"]:
            self.assertIsNone(item["problem"], item["name"])
            self.assertEqual(set(item), described("headline"))
            self.assertTrue(item["converged"], item["name"])
            for field in ("unknowns", "multipliers", "inequalities", "products"):
                self.assertGreater(item[field], 0, item["name"])
            for field in ("seconds_total", "seconds_solve", "peak_memory_mib"):
                least, median, most = (item[field][key] for key in ("least", "median", "most"))
                self.assertTrue(0.0 < least <= median <= most, item["name"])
        self.assertEqual(page.read_text(encoding="utf-8"), headline_page.page(document))
        self.assertEqual(json.loads(headline_page.as_json(document)), document)
        for item in document["runs"]:
            if item["name"].startswith("hertz"):
                self.assertEqual(len(item["from_theory"]), 3, item["name"])
        headline_page.readme_block(document)
        # Not a single case may be missing where the README is written.
        for gone in ("large", "plain-4x32"):
            rest = [item for item in document["runs"] if item["name"] != gone]
            with self.assertRaisesRegex(headline_page.Incomplete, gone):
                headline_page.readme_block({**document, "runs": rest})

    def test_headline_shows_what_it_skips(self):
        """Too little memory: the case is not run, JSON and page say why, no README is written."""
        case = headline.CASES["paper-unshared"]
        given = argparse.Namespace(quick=False, runs=1, np=2)
        with unittest.mock.patch.object(headline, "memory_mib", lambda field: 100):
            entry = headline.measure(case, given)
        self.assertEqual(entry["problem"], "skipped: needs 9216 MiB of free memory, 100 MiB are free")
        self.assertIn(entry["problem"], headline_page.row(entry))
        self.assertTrue(headline.is_within_limits(entry))
        with self.assertRaisesRegex(headline_page.Incomplete, "paper-unshared was skipped"):
            headline_page.needed({case.name: entry}, case.name)

    def test_headline_checks_memory_limits(self):
        entry = {"problem": None, "converged": True, "memory_limit_mib": 8192}
        for most, kept in ((8191, True), (8192, False)):
            entry["peak_memory_mib"] = {"least": 8000, "median": 8100, "most": most}
            self.assertEqual(headline.is_within_limits(entry), kept)

    def test_headline_names_the_nearest_case(self):
        script = [sys.executable, HERE / "headline.py"]
        status, _, errors = runs.execute([*script, "--only", "paper-shard"])
        self.assertEqual(status, 2)
        self.assertIn("there is no case paper-shard; did you mean paper-shared?", errors)

    def test_real_bodies_page(self):
        """From any runs: tables of what was measured, later runs in the place of earlier ones."""
        def made(problem, products, seed=1, **more):
            cut = {"partition": "compact", "seed": seed, "parts": 24, "tolerance": 1e-4}
            sizes = {"unknowns": 900, "inequalities": 70 * (problem == "contact"), "active_sets": 3}
            item = {"scene": "half-ball", "problem": problem, **cut, **sizes, "products": products, **more}
            return {"harmos": f"of {products}", "ranks": 2, "parts": [24], "runs": [item]}

        linear, again = made("linear", 40), made("linear", 20)
        merged = real_bodies_page.merged([linear, again])
        self.assertEqual([item["products"] for item in merged["runs"]], [20])
        page = real_bodies_page.page(merged)
        self.assertIn("`of 20`, 2 ranks", page)
        self.assertNotIn("## Contact", page)
        self.assertNotIn("## Seeds", page)
        merged = real_bodies_page.merged([linear, again, made("linear", 25, seed=2), made("contact", 30)])
        page = real_bodies_page.page(merged)
        self.assertIn("| `half-ball` | compact | 30 | 1.00 | 3 |", page)
        self.assertIn("| `half-ball` | compact | 1.50 |", page)
        self.assertIn("| `half-ball` | linear | compact | 20 to 25 (2 seeds, 1.25) |", page)
        self.assertEqual(json.loads(real_bodies_page.as_json(merged)), merged)
        self.assertEqual(real_bodies_page.merged([merged]), merged)
        failed = made("contact", 30, problem_of_run="failed")
        del failed["runs"][0]["products"]
        page = real_bodies_page.page(real_bodies_page.merged([merged, failed]))
        self.assertIn("| `half-ball` | compact | failed | — | 3 |", page)
        with self.assertRaisesRegex(ValueError, "several tolerances"):
            real_bodies_page.merged([linear, made("contact", 9, tolerance=1e-6)])

    def test_unstructured_skips_visibly(self):
        """Without petsc4py, or Gmsh's module: status 77 and a line that names what to install."""
        hidden = "import sys, unstructured as u; u.gmsh_meshes.available = lambda: False; sys.argv[1:] = []; u.main()"
        script = [sys.executable, "-c", f"import sys; sys.path[:0] = [{str(HERE)!r}]; {hidden}"]
        status, _, errors = runs.execute(script)
        self.assertEqual(status, runs.SKIPPED)
        self.assertIn(f"SKIP: Debian's {gmsh_meshes.PACKAGE}", errors)

    def test_calculix_models(self):
        output, page = runs.scratch("calculix"), runs.scratch("page")
        words = [sys.executable, HERE / "calculix/calculix_models.py", "beamt", "c3d15", "hueeber1", "beamcr",
                 "--output", output, "--page", page]
        status, _, errors = runs.execute(words)
        if status == runs.SKIPPED:
            self.assertRegex(errors, "SKIP: Debian's .* must be installed")
            self.skipTest(errors.strip())
        self.assertEqual(status, 0, errors)
        entries = json.loads(output.read_text(encoding="utf-8"))["runs"]
        self.assertEqual([entry["name"] for entry in entries if not entry["outside"]], ["beamt", "c3d15", "hueeber1"])
        fields = described("calculix_models")
        for entry in entries:
            self.assertLessEqual(set(entry), fields)
        for name, entry in ((entry["name"], entry) for entry in entries if not entry["outside"]):
            self.assertEqual(entry["status"], "agrees", name)
        self.assertIn("| beamt |", page.read_text(encoding="utf-8"))

    def test_cases_of_the_performance_model(self):
        """What C++ is compared with is what the program writes."""
        output = runs.scratch("cases")
        status, _, errors = runs.execute([sys.executable, HERE / "performance_model.py", "--cases", output])
        self.assertEqual(status, 0, errors)
        kept = HERE.parent / "unit" / "feti" / "step_model_cases.json"
        self.assertEqual(
            output.read_text(encoding="utf-8"),
            kept.read_text(encoding="utf-8"),
            f"performance_model.py --cases {kept} writes it anew; unit_feti_models compares C++ with it",
        )


class Sweeps(Scripts):
    """Programs that run many decks: long."""

    def test_real_bodies_table(self):
        words = ["--scale", "12", "--only", "half-ball", "half-disc", "--parts", "8"]
        document = self.script("real_bodies_table.py", *words)
        self.assertEqual(len(document["runs"]), 2 * 2 * 2)
        for item in document["runs"]:
            self.assertEqual(set(item), described("real_bodies_table"))
            self.assertEqual(item["solver"], "PCPG" if item["problem"] == "linear" else "PDAS")
            self.assertLessEqual(item["products"], 40, item)

    def test_forms(self):
        # Which of such small ones is the fastest is noise, and so is the exit status.
        document = self.script("forms.py", "--only", "model-1x8", "half-disc", "--scale", "3", statuses=(0, 1))
        for item in document["runs"]:
            self.assertEqual(set(item), described("forms"))
            self.assertEqual(len(item["combinations"]), 8)
            self.assertEqual(len(item["auto"]["dual_operator"]), 1)

    def test_shape_cost(self):
        if not (runs.BINARY / "bin/shape").is_file():
            self.skipTest("the program shape is not built (HARMOS_ENABLE_ROL)")
        words = ["--scale", "9", "--repetitions", "1", "--only", "shared", "unshared", "nodes", "moved"]
        document = self.script("shape/shape_cost.py", *words)
        for item in document["runs"]:
            self.assertEqual(set(item), described("shape_cost"))
            self.assertLess(item["peak_over_mean"], item["peak_over_mean_before"], item)
            if item["name"] != "moved":  # gaps change no matrix
                self.assertEqual(item["factorisations"], item["factorisations_of_first"], item)

    def test_unstructured(self):
        """Harmos and the peer come to the same energies and contacts, and the page is written from the JSON."""
        if not gmsh_meshes.available() or peer_petsc.directory() is None:
            self.skipTest(f"{gmsh_meshes.PACKAGE} or {peer_petsc.PACKAGE} is missing")
        page = runs.scratch("page")
        words = ["--only", "half-ball", "ball-on-block", "--scale", "4", "--parts", "8", "--repetitions", "1"]
        document = self.script("unstructured.py", *words, "--page", page)
        self.assertEqual([item["name"] for item in document["runs"]], ["half-ball", "ball-on-block"])
        for item in document["runs"]:
            self.assertEqual(set(item), described("unstructured"))
            self.assertIsNone(item["problem"], item)
            self.assertLessEqual(item["energy_difference"], item["energy_tolerance"], item)
            for way in ("plain", "reused", "best"):
                self.assertEqual(item[way]["sets"][-1]["changed"], 0, item)
                self.assertGreater(item[way]["closed"], 0, item)
        ball = document["runs"][0]
        self.assertEqual(ball["best"]["candidates"], ball["harmos"]["inequalities"])
        self.assertEqual(ball["best"]["closed"], ball["plain"]["closed"])
        self.assertLessEqual(abs(ball["best"]["closed"] - ball["harmos"]["closed"]), 1)
        self.assertEqual(page.read_text(encoding="utf-8"), unstructured_page.page(document))
        self.assertEqual(json.loads(unstructured_page.as_json(document)), document)

    def test_hertz_spread(self):
        document = self.script("hertz_spread.py", "--series", "approach")
        self.assertEqual(len(document["runs"]), 5)
        for item in document["runs"]:
            self.assertEqual(set(item), described("hertz_spread"))
            self.assertEqual(item["solver"], "PDAS")
        self.assertGreaterEqual(document["spreads"]["approach"], 1.0)

    def test_cutting(self):
        document = self.script("cutting.py", "--cells", "6000", "--parts", "8", "--repetitions", "1")
        self.assertEqual([item["cells"] for item in document["runs"]], [6000])
        for item in document["runs"]:
            self.assertEqual(set(item), described("cutting"))
            self.assertGreater(item["metis_seconds"], 0.0)

    def test_transient_steps(self):
        document = self.script("transient/transient_steps.py", "--size", "0.2", "--steps", "5")
        self.assertEqual([item["scene"] for item in document["runs"]], ["plane", "plane", "space", "space"])
        for item in document["runs"]:
            self.assertEqual(set(item), described("transient_steps"))
            self.assertEqual(item["steps"], 5)

    def test_adaptive_curves(self):
        document = self.script("adaptive/adaptive_curves.py", "--scenes", "corner", "--repetitions", "1", "--coarser", "4")
        (item,) = document["runs"]
        self.assertEqual(set(item), described("adaptive_curves"))
        self.assertEqual(len(item["points"]), 10)
        self.assertGreater(item["rate_adapted"], 2.0 * item["rate_uniform"])
        for efficiency in item["efficiency"]:
            self.assertTrue(0.7 < efficiency < 1.3, item["efficiency"])

    def test_scaling(self):
        document = self.script("scaling.py", "--cells", "2x8", "--repetitions", "1")
        self.assertEqual([item["kind"] for item in document["speedups"]], ["unshared", "shared"])
        self.assertEqual([item["ranks"] for item in document["steps"]], [1, 2, 1, 2])

    def test_performance_model(self):
        """Weak scaling: the local work stays, the coarse problem grows and takes over; distributed, later."""
        for physics in ("membrane", "solid"):
            taken = []
            for form in ("replicated", "distributed", "auto"):
                document = self.script("performance_model.py", "--physics", physics, "--form", form)
                steps = document["steps"]
                self.assertEqual((steps[0]["ranks"], steps[-1]["ranks"]), (1, 100000))
                for item in steps:
                    self.assertEqual(set(item), described("performance_model"))
                    self.assertEqual(item["products"], steps[0]["products"])
                    self.assertEqual(item["gathers"] > 0, item["form"] == "distributed" and item["ranks"] > 1)
                self.assertLess(steps[0]["coarse"], steps[-1]["coarse"])
                self.assertEqual(steps[0]["messages"] + steps[0]["collective_bytes"], 0)
                taken.append(document["coarse_takes_over_at"])
                self.assertTrue(steps[0]["ranks"] < taken[-1] < steps[-1]["ranks"])
                self.assertLess(document["distributed_from"], taken[-1])
            self.assertLess(taken[0], taken[1])
            self.assertEqual(taken[1], taken[2])


if __name__ == "__main__":
    runs.main()
