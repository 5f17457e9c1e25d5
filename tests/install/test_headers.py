# SPDX-License-Identifier: BSD-3-Clause
"""Installed headers are self-sufficient: each alone is a translation unit, with the targets' flags."""

import os
import shlex
import subprocess
import sys
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

from harmos_install import InstalledTree, run  # noqa: E402

PROJECT = """
cmake_minimum_required(VERSION 3.22)
project(headers LANGUAGES C CXX)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
find_package(Harmos CONFIG REQUIRED)
add_library(probe OBJECT probe.cpp)
target_link_libraries(probe PRIVATE Harmos::effects)
"""


class Headers(unittest.TestCase):
    def test_each_compiles_alone(self):
        tree = InstalledTree()
        try:
            project = tree.scratch / "project"
            project.mkdir()
            (project / "CMakeLists.txt").write_text(PROJECT)
            (project / "probe.cpp").write_text("\n")
            build = tree.scratch / "build"
            run("cmake", "-S", project, "-B", build, f"-DCMAKE_PREFIX_PATH={tree.prefix}")
            flags = next(build.rglob("flags.make")).read_text()
            words = []
            for line in flags.splitlines():
                for key in ("CXX_DEFINES", "CXX_INCLUDES", "CXX_FLAGS"):
                    if line.startswith(key + " = "):
                        words += shlex.split(line.split(" = ", 1)[1])

            def compiled(header):
                command = ["mpicxx", *words, "-fsyntax-only", "-x", "c++", "-include", str(header), "/dev/null"]
                done = subprocess.run(command, capture_output=True, text=True, check=False)
                return header.name, done.returncode, done.stderr

            headers = sorted((tree.prefix / "include" / "harmos").glob("*.hpp"))
            self.assertGreater(len(headers), 100)
            with ThreadPoolExecutor(os.cpu_count()) as pool:
                bad = [(name, text[:1500]) for name, status, text in pool.map(compiled, headers) if status != 0]
            self.assertEqual(bad, [], "\n".join(f"{name}: {text}" for name, text in bad))
        finally:
            tree.remove()


if __name__ == "__main__":
    from harmos_runs import main

    main()
