# SPDX-License-Identifier: BSD-3-Clause
"""Harmos as others get it: installed, moved, found by CMake, packed for Debian.

What each class guards against:

    Consumer    a target without what it needs, a header that was left behind, a path of the machine that built it;
                a language or a header that an embedder would not think of;
                components that ask for more than they stand on, or that are not refused when there are none
    Programs    installed programs that look for their tools and decks in the sources
    Package     a Debian package without its dependencies or files
"""

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
                printed, r"up: .*nothing to hold it: subdomains 0, 1, 2, 3, 4, 5, 6, 7, 8\n"
            )
            self.assertRegex(printed, r'refused: .*"Tolerence".*"Tolerance"')

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
        for version, fits in (("0.1.0", True), ("0.2", False), ("1.0", False)):
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
        self.assertTrue((prefix / "share" / "harmos" / "tools" / "plot_run.py").is_file())

    def test_jobs_are_made_from_the_installed_tree(self):
        share = self.tree.prefix / "share" / "harmos"
        for scheduler in ("slurm", "pbs"):
            script = run(
                share / "cluster" / "submit.py",
                share / "decks" / "harmos" / "two_blocks.xml",
                "--dry-run",
                "--scheduler",
                scheduler,
                "--output",
                self.tree.scratch / "job",
            ).stdout
            self.assertIn(str((self.tree.prefix / "bin" / "harmos").resolve()), script)


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
            files = run("dpkg-deb", "--contents", package).stdout
            for name in ("/usr/bin/signorini", "/usr/include/harmos/Harmos_Qp.hpp", "HarmosConfig.cmake"):
                self.assertIn(name, files)
        finally:
            shutil.rmtree(scratch, ignore_errors=True)


if __name__ == "__main__":
    from harmos_runs import main

    main()
