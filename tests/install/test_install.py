# SPDX-License-Identifier: BSD-3-Clause
"""Harmos as others get it: installed, moved, found by CMake, packed for Debian.

What each class guards against:

    Consumer    a target without what it needs, a header that was left behind, a path of the machine that built it;
                a language or a header that an embedder would not think of;
                components that ask for more than they stand on, or that are not refused when there are none
    Programs    installed programs that look for their decks in the sources
    Tools       tools that are not on PATH, or take a module or a template from the sources; that do not explain themselves,
                or end in a traceback where Python lacks what they need
    Package     a Debian package without its dependencies or files, or whose tools do not find their modules
"""

import functools
import os
import shutil
import sys
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

from harmos_install import BINARY, SOURCE, InstalledTree, run  # noqa: E402

MPIEXEC = os.environ.get("HARMOS_MPIEXEC", "mpiexec")


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.tree = InstalledTree()

    @classmethod
    def tearDownClass(cls):
        cls.tree.remove()

    def configure(self, name, *components, project="consumer", **more):
        build = self.tree.scratch / name
        return build, run(
            "cmake",
            "-S",
            SOURCE / "tests" / "install" / project,
            "-B",
            build,
            f"-DCMAKE_PREFIX_PATH={self.tree.prefix}",
            f"-DCOMPONENTS={';'.join(components)}",
            f"-DEXAMPLES={SOURCE / 'docs' / 'examples'}",
            "-DCMAKE_BUILD_TYPE=Release",
            "-DCMAKE_CXX_FLAGS_RELEASE=-O0",  # what is linked to is optimised
            *([f"-DCMAKE_CXX_COMPILER_LAUNCHER={shutil.which('ccache')}"] if shutil.which("ccache") else []),
            *(f"-D{key}={value}" for key, value in more.items()),
            check=False,
        )


class Consumer(Installed):
    EXAMPLES = {
        "obstacle": ("MPRGP", "converged", "900 of 4096"),
        "embed_qp": ("half 0: converged", "half 1: converged"),
        "embed_feti": ("new factorisations 0",),
        "embed_stratimikos": ("residual below 1e-8: yes",),
        "embed_operators": ("stiffness of the chain 0.2",),
    }

    def test_builds_and_runs(self):
        build, configured = self.configure("consumer", "qp", "feti", "thyra", "scene")
        self.assertEqual(configured.returncode, 0, configured.stdout + configured.stderr)
        run("cmake", "--build", build, "--parallel", "2")
        for example, words in self.EXAMPLES.items():
            printed = run(MPIEXEC, "-np", "2", build / example).stdout
            for word in words:
                self.assertIn(word, printed)

    def test_a_project_of_cxx_alone_with_one_header(self):
        build, configured = self.configure("first_hour", project="first_hour")
        self.assertEqual(configured.returncode, 0, configured.stdout + configured.stderr)
        run("cmake", "--build", build, "--parallel", "2")
        for ranks in ("1", "2"):
            printed = run(MPIEXEC, "-np", ranks, build / "first_hour").stdout
            self.assertIn("down: converged\n", printed)
            self.assertRegex(
                printed, r"up: .*unconstrained rigid-body mode under load: subdomains 0, 1, 2, 3, 4, 5, 6, 7, 8\n"
            )
            self.assertRegex(printed, r'refused: .*"Solver/Tolerence"; did you mean "Tolerance"')

    def test_one_component_asks_for_no_more_than_it_needs(self):
        # Where MUMPS, METIS and HDF5 are hidden.
        _, configured = self.configure(
            "qp_only", "qp", MUMPS_INCLUDE_DIR="MUMPS_INCLUDE_DIR-NOTFOUND", CMAKE_DISABLE_FIND_PACKAGE_HDF5="ON"
        )
        self.assertEqual(configured.returncode, 0, configured.stdout + configured.stderr)
        for hidden in ("METIS_LIBRARY", "HDF5_DIR", "Amesos2_DIR"):
            self.assertNotIn(hidden + ":", (self.tree.scratch / "qp_only" / "CMakeCache.txt").read_text())

    def test_unknown_components_are_refused_by_name(self):
        _, configured = self.configure("unknown", "friction")
        self.assertNotEqual(configured.returncode, 0)
        self.assertIn('no component "friction"', configured.stderr)

    def test_versions_before_1_must_agree_in_the_minor_number(self):
        for version, fits in (("0.2.0", True), ("0.1", False), ("1.0", False)):
            _, configured = self.configure(f"version_{version}", "core", WANTED=version)
            self.assertEqual(configured.returncode == 0, fits, version + configured.stdout + configured.stderr)

    def test_nothing_points_to_the_sources_or_the_first_place(self):
        for place in (self.tree.prefix / "lib").rglob("*.cmake"):
            text = place.read_text()
            for path in (str(SOURCE), str(BINARY), str(self.tree.scratch / "first")):
                self.assertNotIn(path, text, f"{place} names {path}")


class Programs(Installed):
    def test_a_deck_is_run_from_the_installed_tree(self):
        prefix = self.tree.prefix
        output = self.tree.scratch / "run"
        run(
            MPIEXEC,
            "-np",
            "2",
            prefix / "bin" / "signorini",
            prefix / "share" / "harmos" / "decks" / "signorini" / "model.xml",
            "--output",
            output,
        )
        for name in ("summary.json", "iterations.csv", "result.vtkhdf"):
            self.assertTrue((output / name).is_file(), name)


class Tools(Installed):
    # What --help has to speak of, beside what all do.
    HELP = {
        "harmos-exodus": ("result.vtkhdf", "result.exo", "blocks", "--output"),
        "harmos-inp": ("MODEL.xml", "MODEL.msh", "listed", "--output"),
        "harmos-plot": ("result.vtkhdf", "solution.png", "convergence.png", "contact.png", "scaling.csv", "--follow", "curve.png", "steps.gif", "damage.png", "shape.png"),
        "harmos-study-plot": ("study.json", "error_against_seconds", "error_parts"),
        "harmos-submit": ("harmos.slurm", "harmos.pbs", "--scaling weak", "--dry-run", "--resubmissions"),
    }

    def tool(self, name, *words, hidden=None):
        """By its name on PATH, with another python3 before it; hidden is a module that cannot be imported."""
        place = self.tree.scratch / f"without_{hidden}"
        place.mkdir(exist_ok=True)
        if hidden:
            (place / f"{hidden}.py").write_text("raise ImportError('hidden by a test')\n")
        (place / "python3").write_text("#!/bin/sh\nexit 99\n")
        (place / "python3").chmod(0o755)
        path = f"PATH={place}:{self.tree.prefix / 'bin'}:{os.environ['PATH']}"
        return run("env", path, f"PYTHONPATH={place}", name, *words, check=False)

    @functools.cached_property
    def finished(self):
        """The directory of a small run."""
        output = self.tree.scratch / f"{self.id()}_run"
        deck = self.tree.prefix / "share" / "harmos" / "decks" / "signorini" / "model.xml"
        run(self.tree.prefix / "bin" / "signorini", deck, "--output", output)
        return output

    def test_each_explains_itself(self):
        for name, words in self.HELP.items():
            with self.subTest(name):
                # Where pictures cannot be drawn, too.
                told = self.tool(name, "--help", hidden="numpy")
                self.assertEqual((told.returncode, told.stderr), (0, ""))
                self.assertRegex(told.stdout, r"Reads\s(.|\n)*[Ww]rites\s(.|\n)*Exit status: 0 ")
                for word in (f"\nexamples:\n  {name} ", "(default: ", *words):
                    self.assertIn(word, told.stdout)

    def test_nothing_is_taken_from_the_sources(self):
        for name in self.HELP:
            place = (self.tree.prefix / "bin" / name).resolve()
            self.assertIn(self.tree.prefix.resolve(), place.parents)
        for pattern in ("*.py", "inp/*.py", "jobs/*"):
            here, there = SOURCE / "apps" / "tools", self.tree.prefix / "share" / "harmos" / "tools"
            self.assertEqual({p.name for p in there.glob(pattern)}, {p.name for p in here.glob(pattern)})

    def test_pictures_are_drawn_through_a_link(self):
        link = self.tree.scratch / "link"
        link.symlink_to(self.tree.prefix / "bin" / "harmos-plot")
        drawn = self.tool(link, self.finished, "--dpi", "50")
        if "cannot import" in drawn.stderr:
            self.skipTest(drawn.stderr)
        self.assertEqual((drawn.returncode, drawn.stderr), (0, ""))
        for name in ("solution.png", "convergence.png"):
            self.assertTrue((self.finished / name).is_file(), drawn.stdout)

    def test_every_module_is_there(self):
        """As far as the sentence that there is nothing to draw."""
        empty = self.tree.scratch / "empty"
        empty.mkdir()
        for words, sentence in (
            (("harmos-plot", empty), "summary.json"),
            (("harmos-plot", empty, "--scaling", "auto"), "no converged run"),
            (("harmos-plot", empty, "--curve", "time"), "steps.csv"),
            (("harmos-study-plot", empty), "run study first"),
        ):
            refused = self.tool(*words)
            if "cannot import" in refused.stderr:
                self.skipTest(refused.stderr)
            self.assertEqual(refused.returncode, 2, refused.stderr)
            self.assertRegex(refused.stderr, rf"^{words[0]}: .*{sentence}.*\n$")

    def test_a_missing_module_is_named(self):
        for name, module in (
            ("harmos-plot", "numpy"),
            ("harmos-plot", "matplotlib"),
            ("harmos-plot", "h5py"),
            ("harmos-study-plot", "matplotlib"),
        ):
            with self.subTest(name=name, module=module):
                refused = self.tool(name, self.finished, hidden=module)
                self.assertEqual((refused.returncode, refused.stdout), (2, ""), refused.stderr)
                self.assertRegex(
                    refused.stderr,
                    rf"^{name}: .*/python3 cannot import {module} \(hidden by a test\): install Debian's package "
                    rf"python3-{module} for /usr/bin/python3, or use an interpreter that has it, as in "
                    rf"PYTHON \S+/{name} DIR\n$",
                )

    def test_files_of_something_else_are_refused_in_a_sentence(self):
        place = self.tree.scratch / "else"
        (place / "1").mkdir(parents=True)
        (place / "iterations.csv").write_bytes(b"\xff\xfe")
        (place / "summary.json").write_text("{}")
        (place / "1" / "summary.json").write_text('{"converged": true}')
        (place / "study.json").write_text('{"runs": [1]}')
        for words in (
            ("harmos-plot", place),
            ("harmos-plot", place, "--scaling", "auto"),
            ("harmos-study-plot", place),
            ("harmos-study-plot", self.tree.scratch / "nowhere"),
        ):
            with self.subTest(words=words):
                refused = self.tool(*words)
                if "cannot import" in refused.stderr:
                    self.skipTest(refused.stderr)
                self.assertEqual((refused.returncode, refused.stdout), (2, ""), refused.stderr)
                self.assertEqual(refused.stderr.count("\n"), 1, refused.stderr)
        self.assertFalse((self.tree.scratch / "nowhere").exists())

    def test_jobs_are_made(self):
        deck = self.tree.prefix / "share" / "harmos" / "decks" / "harmos" / "two_blocks.xml"
        for scheduler in ("slurm", "pbs"):
            words = (deck, "--dry-run", "--scheduler", scheduler, "--output", self.tree.scratch / "job")
            made = self.tool("harmos-submit", *words, hidden="numpy")
            self.assertEqual((made.returncode, made.stderr), (0, ""))
            self.assertIn(str((self.tree.prefix / "bin" / "harmos").resolve()), made.stdout)


class Package(unittest.TestCase):
    def test_debian_package(self):
        if not shutil.which("dpkg-shlibdeps") or not shutil.which("cpack"):
            self.skipTest("no dpkg-shlibdeps (dpkg-dev) or no cpack")
        scratch = Path(os.environ.get("TMPDIR", "/tmp")) / f"harmos_package_{os.getpid()}"
        try:
            run("cpack", "--config", BINARY / "CPackConfig.cmake", "-B", scratch)
            (package,) = scratch.glob("harmos_*.deb")
            fields = run("dpkg-deb", "--field", package).stdout
            for library in ("libtrilinos-tpetra", "libmumps", "libmetis", "libhdf5"):
                self.assertIn(library, fields)
            if "HARMOS_ENABLE_GMSH:BOOL=ON" in (Path(BINARY) / "CMakeCache.txt").read_text():
                self.assertRegex(fields, r"(?m)^Depends: .*\blibgmsh")  # loaded by name
            for module in ("h5py", "matplotlib", "numpy", "vtk9"):
                self.assertRegex(fields, rf"(?m)^Recommends: .*\bpython3-{module}\b")
            self.assertRegex(fields, r"(?m)^Depends: .*\bpython3(,|$)")
            files = run("dpkg-deb", "--contents", package).stdout
            for name in ("/usr/bin/signorini", "/usr/include/harmos/Harmos_Qp.hpp", "HarmosConfig.cmake"):
                self.assertIn(name, files)
            unpacked = scratch / "unpacked"
            run("dpkg-deb", "--extract", package, unpacked)
            for name in Tools.HELP:
                # It begins with its module, which lies elsewhere in the package.
                self.assertIn("examples:", run(unpacked / "usr" / "bin" / name, "--help").stdout)
            for name in ("plot_run.py", "plot_study.py", "plot_scaling.py", "plot_solid.py", "vtk_scene.py", "jobs/harmos.slurm", "jobs/job.sh"):
                self.assertIn(f"/usr/share/harmos/tools/{name}\n", files)
        finally:
            shutil.rmtree(scratch, ignore_errors=True)


if __name__ == "__main__":
    from harmos_runs import main

    main()
