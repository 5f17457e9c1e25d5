# SPDX-License-Identifier: BSD-3-Clause
"""The command line and the deck of an application, from outside.

What each class guards against:

    BadInput       input that is wrong and accepted, or refused in words that do not help: a wrong
                   exit status, no path, no nearest name, a message a rank; --check that misses
                   what a run would refuse, or that leaves files behind
    Lexical        text in a deck that is not of its declared type and becomes another value
    Files          input errors that damage the results of an earlier run
    Check          --check that refuses a good deck, or solves
    Information    --version, --help and --quiet that print too much, too
                   little or once a rank
    NotConverged   a run without a solution that looks like one with a solution
    Ranks          more ranks than subdomains: ranks that own nothing
    Launcher       a launcher that loses a rank (PID 0) fails a test; one that says anything else does not
"""

import json
import math
import re
import subprocess
import sys
import unittest
from pathlib import Path
from unittest import mock

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402

# What other programs read; more may come, nothing may go.
KINDS = ("start", "cg", "expansion", "proportioning", "pcpg", "active set")
COLUMNS = (
    "outer inner step projected_gradient equality_residual penalty M active hessian_applications "
    "seconds"
).split()
SUMMARY = set(
    "harmos deck ranks converged reason primal_dimension dual_dimension inequalities "
    "kernel_dimension subdomains outer_iterations hessian_applications setup_applications "
    "cg_steps expansion_steps proportioning_steps faces relative_projected_gradient "
    "relative_equality_residual energy audit effects dual_operator solver "
    "distinct_local_factorizations seconds peak_memory_mib".split()
)
AUDIT = set("equilibrium gluing_jump penetration min_contact_multiplier complementarity".split())
STAGES = set("mesh assembly factorization dual_operator coarse solve recovery output total".split())

# One subdomain a body, 2 x 2 elements each: as fast as a run can be.
TINY = {"Model/Subdomains per side": 1, "Model/Elements per subdomain side": 2}


def parameter(name, kind, value):
    return f'<Parameter name="{name}" type="{kind}" value="{value}"/>'


def sublist(name, *content):
    return f'<ParameterList name="{name}">{"".join(content)}</ParameterList>'


def deck(*content):
    return sublist("signorini", *content)


class Case(unittest.TestCase):
    def setUp(self):
        # The present directory of the runs: "Output/Directory" is relative to it.
        self.place = runs.scratch("place")
        self.place.mkdir()

    def write(self, text, name="deck.xml"):
        path = self.place / name
        path.write_text(text, encoding="utf-8")
        return path

    def start(self, words, np):
        return runs.start(words, np=np, cwd=self.place)

    def assert_refused(self, result, fragments, one_line=True):
        """Exit status 2 and one message, which holds all fragments."""
        self.assertEqual(result.returncode, 2, result)
        self.assertEqual(len(result.errors), 1, result)
        text = re.sub("(?m)^warning: .*$", "", result.stderr)
        for fragment in fragments:
            # Once on the whole stream: a second rank would repeat it.
            self.assertEqual(text.count(fragment), 1, f"{fragment!r}{result}")
            if one_line:
                self.assertIn(fragment, result.errors[0])

    def refuse(self, words, *fragments, checked=True, one_line=True):
        """These words are refused: by --check on one rank as by a run on two."""
        before = sorted(self.place.iterdir())
        for np in (1, 2):
            extra = ["--check"] if checked and np == 1 else []
            with self.subTest(ranks=np, words=extra):
                result = self.start([*words, *extra], np)
                self.assert_refused(result, fragments, one_line)
                self.assertEqual(sorted(self.place.iterdir()), before, "files were left behind")

    def refuse_deck(self, text, *fragments, one_line=True):
        path = self.write(text)
        self.refuse([path], *fragments, one_line=one_line)

    def refuse_setting(self, setting, *fragments):
        self.refuse([runs.MODEL, "--set", setting], *fragments)


class BadInput(Case):
    def test_unknown_parameter_in_the_deck(self):
        self.refuse_deck(
            deck(sublist("Solver", parameter("Tolerence", "double", "1e-4"))),
            'unknown parameter "Solver/Tolerence"',
            'did you mean "Tolerance"?',
            'Allowed here: "Method", "Tolerance", ',
            "deck.xml",
        )

    def test_unknown_parameter_in_a_sublist_of_the_deck(self):
        self.refuse_deck(
            deck(sublist("Solver", sublist("Expert", sublist("SMALBE", parameter("Penalty facto", "double", "2"))))),
            'unknown parameter "Solver/Expert/SMALBE/Penalty facto"',
            'did you mean "Penalty factor"?',
        )

    def test_unknown_parameter_by_set(self):
        self.refuse_setting(
            "Solver/Tolerence=1e-4",
            '--set: unknown parameter "Solver/Tolerence"',
            'did you mean "Tolerance"?',
        )

    def test_unknown_parameter_in_a_sublist_by_set(self):
        # With the whole path: "Parameter scaling", for instance, stands in two lists.
        self.refuse_setting(
            "Solver/Expert/SMALBE/Penalty facto=2",
            '--set: unknown parameter "Solver/Expert/SMALBE/Penalty facto"',
            'did you mean "Penalty factor"?',
        )

    def test_unknown_list_in_the_deck(self):
        self.refuse_deck(
            deck(sublist("Solvr", parameter("Tolerance", "double", "1e-4"))),
            'unknown list "Solvr"',
            'did you mean "Solver"?',
        )

    def test_unknown_list_by_set(self):
        fragments = '--set: unknown list "Modl"', 'did you mean "Model"?'
        self.refuse_setting("Modl/Interface=tie", *fragments)

    def test_string_where_a_real_number_belongs(self):
        self.refuse_deck(
            deck(sublist("Solver", parameter("Tolerance", "string", "1e-4"))),
            '"Solver/Tolerance" is a string ("1e-4"), expected a real number (type="double")',
        )

    def test_real_number_where_an_integer_belongs(self):
        self.refuse_deck(
            deck(sublist("Solver", parameter("Maximum iterations", "double", "3.0"))),
            '"Solver/Maximum iterations" is a real number (3), expected an integer (type="int")',
        )

    def test_list_where_a_number_belongs(self):
        self.refuse_deck(
            deck(sublist("Solver", sublist("Tolerance"))),
            '"Solver/Tolerance" is a list, expected a real number',
        )

    def test_number_where_a_list_belongs(self):
        self.refuse_deck(
            deck(parameter("Solver", "int", "3")),
            '"Solver" is a single value, expected a ParameterList',
        )

    def test_text_that_is_no_number_by_set(self):
        for setting, name, value in (
            ("Solver/Tolerance=small", "Solver/Tolerance", "small"),
            ("Solver/Tolerance=1e-4x", "Solver/Tolerance", "1e-4x"),
            ("Solver/Tolerance=", "Solver/Tolerance", ""),
            ("Solver/Maximum iterations=2.5", "Solver/Maximum iterations", "2.5"),
            ("Solver/Maximum iterations=99999999999", "Solver/Maximum iterations", "99999999999"),
            ("Output/Fields=yes", "Output/Fields", "yes"),
        ):
            with self.subTest(setting=setting):
                # All take the same way through the program: one run each will do.
                result = self.start([runs.MODEL, "--check", "--set", setting], 0)
                fragment = f'--set: "{value}" is not a valid value of "{name}", expected'
                self.assert_refused(result, [fragment])

    def test_out_of_range_in_the_deck(self):
        self.refuse_deck(
            deck(sublist("Model", parameter("Subdomains per side", "int", "0"))),
            '"Model/Subdomains per side" = 0 is out of range, expected an integer (type="int") '
            "in [1, ",
        )

    def test_out_of_range_by_set(self):
        self.refuse_setting(
            "Solver/Tolerance=1",
            '"Solver/Tolerance" = 1 is out of range, expected a real number (type="double") '
            "in (0, 1)",
        )

    def test_not_a_number_is_in_no_range(self):
        self.refuse_deck(
            deck(sublist("Solver", parameter("Tolerance", "double", "nan"))),
            '"Solver/Tolerance" = nan is out of range',
        )

    def test_choice_that_is_not_allowed(self):
        # There are no synonyms, and letters' case counts.
        self.refuse_setting(
            "Solver/Method=smalbe",
            '"Solver/Method" = "smalbe" is not allowed, expected one of "Auto", ',
            'did you mean "SMALBE"?',
        )

    def test_all_faults_of_a_deck_at_once(self):
        self.refuse_deck(
            deck(
                sublist("Modl"),
                sublist(
                    "Solver",
                    parameter("Tolerance", "double", "7"),
                    parameter("Metod", "string", "Auto"),
                ),
            ),
            "3 faults:",
            'unknown list "Modl"',
            '"Solver/Tolerance" = 7 is out of range',
            'unknown parameter "Solver/Metod"',
            one_line=False,
        )

    def test_faults_of_the_deck_and_of_set_at_once(self):
        path = self.write(deck(sublist("Solver", parameter("Tolerance", "double", "7"))))
        self.refuse(
            [path, "--set", "Model/Interface=glue", "--set", "Solver/Method=Autt"],
            "3 faults:",
            '"Solver/Tolerance" = 7 is out of range',
            '"Model/Interface" = "glue" is not allowed',
            '"Solver/Method" = "Autt" is not allowed',
            one_line=False,
        )

    def test_missing_deck(self):
        self.refuse(["nowhere.xml"], 'the deck "nowhere.xml" cannot be read: No such file')

    def test_directory_as_deck(self):
        self.refuse(["."], 'the deck "." is a directory')

    def test_malformed_xml(self):
        self.refuse_deck(
            '<ParameterList name="signorini">\n<ParameterList name="Solver">\n</ParameterList>\n',
            'deck.xml" is not a well-formed ParameterList: XML parse error at line ',
        )

    def test_malformed_yaml(self):
        path = self.write("signorini:\n  Model: [1,\n", "deck.yaml")
        # The line, as for XML: the place is what the user needs.
        self.refuse([path], 'deck.yaml" is not a well-formed ParameterList: ', "line ")

    def test_xml_that_is_no_parameter_list(self):
        fragments = "is not a well-formed ParameterList: ", "expected tag ParameterList"
        self.refuse_deck("<html/>", *fragments)

    def test_unknown_type(self):
        self.refuse_deck(
            deck(sublist("Solver", parameter("Maximum iterations", "integer", "3"))),
            "is not a well-formed ParameterList: ",
            "integer",
        )

    def test_pcpg_with_contact(self):
        self.refuse_setting(
            "Solver/Method=PCPG",
            'contradictory options: "Solver/Method" = "PCPG"',
            'use "Auto" or "SMALBE" or tie the interface',
        )

    def test_mprgp_with_a_floating_body(self):
        self.refuse_setting(
            "Solver/Method=MPRGP",
            'contradictory options: "Solver/Method" = "MPRGP"',
            "a body without a prescribed displacement",
        )

    def test_set_without_an_equals_sign(self):
        for setting in ("Solver/Tolerance", "=1e-4"):
            self.refuse_setting(setting, f'--set "{setting}" is not of the form "List/Name=value"')

    def test_unknown_option(self):
        for word in ("--nonsense", "another.xml"):
            self.refuse([runs.MODEL, word], "command line: ", f"not expected: {word}")

    def test_option_without_its_value(self):
        self.refuse([runs.MODEL, "--output"], "command line: --output: ", "DIR", checked=False)

    def test_no_deck(self):
        self.refuse([], "command line: no deck given")


class Lexical(Case):
    """A value that is not of its declared type is refused, not read as far as it goes."""

    def assert_not_read(self, *content):
        path = self.write(deck(*content))
        result = self.start([path, "--check"], 0)
        self.assertEqual(result.returncode, 2, result)
        self.assertEqual(len(result.errors), 1, result)

    def test_word_as_integer(self):
        # Not 0, which would be "no iterations at all".
        self.assert_not_read(sublist("Solver", parameter("Maximum iterations", "int", "many")))

    def test_fraction_as_integer(self):
        self.assert_not_read(sublist("Model", parameter("Subdomains per side", "int", "2.5")))

    def test_integer_too_large(self):
        # 2^32 + 3 is 3 in 32 bits.
        entry = parameter("Maximum iterations", "int", "4294967299")
        self.assert_not_read(sublist("Solver", entry))

    def test_number_with_a_tail(self):
        self.assert_not_read(sublist("Solver", parameter("Tolerance", "double", "0.1,5")))

    def test_word_as_boolean(self):
        # Not false, which would leave the user without a result file.
        self.assert_not_read(sublist("Output", parameter("Fields", "bool", "yes")))

    def test_parameter_given_twice(self):
        entries = (parameter("Tolerance", "double", value) for value in ("1e-2", "1e-4"))
        self.assert_not_read(sublist("Solver", *entries))


class Files(Case):
    def test_bad_input_leaves_earlier_results_alone(self):
        output = runs.scratch("results")
        runs.solved(self, runs.MODEL, TINY, np=1, output=output)

        def snapshot():
            return {
                path.name: (path.read_bytes(), path.stat().st_mtime_ns)
                for path in sorted(output.iterdir())
            }

        before = snapshot()
        self.assertEqual(tuple(before), runs.RESULTS)
        for setting in ("Solver/Tolerence=1", "Solver/Tolerance=7", "Solver/Method=PCPG"):
            for np in (0, 2):
                with self.subTest(setting=setting, ranks=max(np, 1)):
                    result = self.start([runs.MODEL, "--output", output, "--set", setting], np)
                    self.assertEqual(result.returncode, 2, result)
                    self.assertEqual(snapshot(), before)

    def test_output_directory_has_the_name_of_a_file(self):
        path = self.write("precious", "results")
        for np in (0, 2):
            with self.subTest(ranks=max(np, 1)):
                result = self.start([runs.MODEL, "--output", path], np)
                self.assert_refused(result, [f'the output directory "{path}" cannot be created: '])
                self.assertEqual(path.read_text(encoding="utf-8"), "precious")

    def test_result_file_that_cannot_be_put_in_place(self):
        # A directory stands where the file belongs; permissions would not stop root.
        for name in runs.RESULTS:
            for np in (0, 2):
                with self.subTest(file=name, ranks=max(np, 1)):
                    output = runs.scratch("results")
                    (output / name).mkdir(parents=True)
                    result = runs.run(runs.MODEL, TINY, np=np, output=output)
                    self.assert_refused(result, [f'{name}" cannot be written: '])
                    self.assertEqual(list(output.glob("*.part")), [], "half a file is left")

    def test_output_directory_of_the_deck(self):
        path = self.write(deck(sublist("Output", parameter("Directory", "string", "a/b"))))
        words = [word for key, value in TINY.items() for word in ("--set", f"{key}={value}")]
        result = self.start([path, "--quiet", *words], 0)
        self.assertEqual(result.returncode, 0, result)
        found = sorted(item.name for item in (self.place / "a" / "b").iterdir())
        self.assertEqual(tuple(found), runs.RESULTS)


class Check(Case):
    def test_decks_of_the_application_are_valid(self):
        decks = sorted(runs.DECKS.glob("*.xml"))
        self.assertGreaterEqual(len(decks), 2)
        for path in decks:
            for np in (0, 2):
                with self.subTest(deck=path.name, ranks=max(np, 1)):
                    result = self.start([path, "--check"], np)
                    self.assertEqual(result.returncode, 0, result)
                    self.assertEqual(result.stdout.count("is valid"), 1, result)
                    self.assertNotIn("Solver:", result.stdout)
                    self.assertEqual(list(self.place.iterdir()), [])

    def test_yaml_deck_is_valid(self):
        path = self.write("signorini:\n  Solver:\n    Tolerance: 1.0e-3\n", "deck.yaml")
        result = self.start([path, "--check"], 0)
        self.assertEqual(result.returncode, 0, result)

    def test_whole_number_where_a_real_one_belongs(self):
        path = self.write(
            deck(sublist("Solver", sublist("Expert", sublist("SMALBE", parameter("Initial penalty", "int", "10")))))
        )
        result = self.start([path, "--check"], 0)
        self.assertEqual(result.returncode, 0, result)

    def test_empty_deck_is_all_defaults(self):
        result = self.start([self.write(deck()), "--check"], 0)
        self.assertEqual(result.returncode, 0, result)


class Information(Case):
    def printed(self, *words, np=2):
        result = self.start(words, np)
        self.assertEqual(result.returncode, 0, result)
        self.assertEqual(result.errors, [], result)
        self.assertEqual(list(self.place.iterdir()), [])
        return result.stdout

    def test_version(self):
        cmake = (runs.SOURCE / "CMakeLists.txt").read_text(encoding="utf-8")
        version = re.search(r"project\([^)]*\bVERSION\s+([\d.]+)", cmake).group(1)
        for np in (0, 2):
            # Name, version and git hash on one line, once.
            pattern = rf"\Asignorini \(Harmos\) {re.escape(version)} \S+\n\Z"
            self.assertRegex(self.printed("--version", np=np), pattern)

    def test_gmsh_is_loaded_for_a_file_only(self):
        """libgmsh and what it brings take half of the start of a program, and 40 MB on each rank."""
        for name in ("signorini", "harmos", "harmos-mesh"):
            linked = subprocess.run(["ldd", runs.application(name)], capture_output=True, text=True, check=True).stdout
            self.assertNotIn("libgmsh", linked, name)

    def test_help(self):
        for words, np in ((("--help",), 0), (("-h",), 2), ((runs.MODEL, "--help"), 2)):
            text = self.printed(*words, np=np)
            self.assertEqual(text.count("signorini [OPTIONS] [deck]"), 1)
            self.assertNotIn("kokkos", text.lower())  # forty lines of its own, from every rank
            for option in ("--set", "--output", "--check", "--print-parameters", "--quiet"):
                self.assertIn(option, text)

    def test_a_run_without_a_launcher_says_nothing_on_stderr(self):
        """Nor does Open MPI, of what its start was told to do without; results are written by MPI's files."""
        result = runs.run(runs.MODEL, TINY, np=0)
        self.assertEqual((result.returncode, result.stderr), (0, ""), result)
        self.assertTrue((result.directory / "result.vtkhdf").is_file())

    def test_quiet_run_prints_nothing(self):
        for np in (0, 2):
            result = runs.run(runs.MODEL, TINY, np=np, extra=["--quiet"])
            self.assertEqual(result.returncode, 0, result)
            self.assertEqual(result.stdout, "")
            self.assertEqual(result.errors, [])

    def test_quiet_does_not_hide_errors(self):
        for np in (0, 2):
            result = self.start([runs.MODEL, "--quiet", "--set", "Solver/Tolerance=7"], np)
            self.assertEqual(result.stdout, "")
            self.assert_refused(result, ['"Solver/Tolerance" = 7 is out of range'])
            result = runs.run(
                runs.MODEL, {"Solver/Maximum iterations": 1}, np=np, extra=["--quiet"]
            )
            self.assertEqual(result.returncode, 1, result)
            self.assertEqual(result.stdout, "")
            self.assertEqual(len(result.errors), 1, result)


class NotConverged(Case):
    def test_iteration_limit(self):
        for np in (0, 2):
            with self.subTest(ranks=max(np, 1)):
                result = runs.run(runs.MODEL, {"Solver/Maximum iterations": 3}, np=np)
                self.assertEqual(result.returncode, 1, result)
                self.assertEqual(len(result.errors), 1, result)
                self.assertIn("the solver did not converge: iteration limit", result.errors[0])
                self.assertNotRegex(result.stdout, "(?m)^Converged")
                summary = result.summary
                self.assertIs(summary["converged"], False)
                self.assertTrue(summary["reason"].startswith("iteration limit"), summary)
                # What was reached is reported as it is: above the tolerance.
                worst = max(
                    summary["relative_projected_gradient"], summary["relative_equality_residual"]
                )
                self.assertGreater(worst, summary["tolerance"])
                self.assert_valid_history(result, inner=3)

    def assert_valid_history(self, result, inner):
        rows = result.iterations()
        self.assertEqual(list(rows[0]), COLUMNS)
        # The first row of another active set is a row more, not a step more.
        numbers = [int(row["inner"]) for row in rows if row["step"] != "active set"]
        self.assertEqual(numbers, list(range(inner + 1)))
        self.assertEqual(rows[0]["step"], "start")
        before = -1
        for row in rows:
            self.assertIn(row["step"], KINDS)
            for name in COLUMNS:
                if name != "step":
                    self.assertTrue(math.isfinite(float(row[name])), row)
            self.assertGreater(int(row["hessian_applications"]), before)
            before = int(row["hessian_applications"])
        self.assertLessEqual(before, result.summary["hessian_applications"])

    def test_outer_iteration_limit(self):
        sets = {"Solver/Method": "SMALBE", "Solver/Expert/SMALBE/Maximum outer iterations": 1}
        result = runs.run(runs.MODEL, {**sets, "Solver/Tolerance": 1e-8})
        self.assertEqual(result.returncode, 1, result)
        self.assertIs(result.summary["converged"], False)
        self.assertRegex(result.summary["reason"], "^iteration limit: the limit of 1 outer")

    def test_history_of_a_converged_run(self):
        for method, cg in (("SMALBE", "cg"), ("PDAS", "pcpg")):
            with self.subTest(method=method):
                result = runs.solved(self, runs.MODEL, {"Solver/Method": method})
                summary = result.summary
                kinds = {cg: "cg", "expansion": "expansion", "proportioning": "proportioning"}
                counts = {kind: summary[name + "_steps"] for kind, name in kinds.items()}
                self.assert_valid_history(result, inner=sum(counts.values()))
                for kind, count in counts.items():
                    self.assertEqual(sum(r["step"] == kind for r in result.iterations()), count)

    def test_summary_is_complete(self):
        result = runs.run(runs.MODEL, {**TINY, "Solver/Maximum iterations": 0}, np=0)
        self.assertEqual(result.returncode, 1, result)
        self.assertEqual(SUMMARY - set(result.summary), set())
        self.assertEqual(AUDIT - set(result.summary["audit"]), set())
        self.assertEqual(STAGES - set(result.summary["seconds"]), set())
        # Strict JSON: no NaN, no Infinity.
        text = (result.directory / "summary.json").read_text(encoding="utf-8")
        json.loads(text, parse_constant=self.fail)


class Ranks(Case):
    def test_more_ranks_than_subdomains(self):
        sets = {
            "Model/Subdomains per side": 1,
            "Model/Elements per subdomain side": 8,
            "Solver/Tolerance": 1e-10,
        }
        energies = []
        for np in (1, 2, 3):
            result = runs.solved(self, runs.MODEL, sets, np=np)
            self.assertEqual(result.summary["ranks"], np)
            self.assertEqual(result.summary["subdomains"], 2)
            self.assertEqual(result.summary["distinct_local_factorizations"], 2)
            energies.append(result.summary["energy"])
        # The energy at the minimum is of second order in the error, but for the part that violates
        # the constraints: of first order, 1e-10 of the multipliers; ten for norm against work.
        self.assertLess(max(energies) - min(energies), 1e-9 * abs(energies[0]))

    def test_check_and_errors_on_ranks_without_subdomains(self):
        words = [runs.MODEL, "--set", "Model/Subdomains per side=1"]
        self.assertEqual(self.start([*words, "--check"], 3).returncode, 0)
        result = self.start([*words, "--set", "Solver/Tolerance=7"], 3)
        self.assert_refused(result, ['"Solver/Tolerance" = 7 is out of range'])


class Launcher(unittest.TestCase):
    def launch(self, remark):
        """A launcher that fails once, with a remark; how often it was started, and its last exit status."""
        place = runs.scratch("launcher")
        place.write_text(
            f'#!/bin/sh\necho started >> {place}.log\n[ "$(wc -l < {place}.log)" -gt 1 ] && exit 0\n'
            f'echo "{remark}" >&2\nexit 1\n',
            encoding="utf-8",
        )
        place.chmod(0o755)
        with mock.patch.object(runs, "MPIEXEC", str(place)):
            status = runs.start([]).returncode
        return Path(f"{place}.log").read_text(encoding="utf-8").count("started"), status

    def test_a_lost_rank_is_no_failure(self):
        self.assertEqual(self.launch("mpiexec has exited due to process rank 0 with PID 0 on"), (2, 0))

    def test_other_failures_are(self):
        self.assertEqual(self.launch("mpiexec has exited due to process rank 0 with PID 4711 on"), (1, 1))


if __name__ == "__main__":
    runs.main()
