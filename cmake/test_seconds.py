#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The dearest tests and cases of a run of CTest, in seconds.

    cmake/test_seconds.py [BUILD TREE, default: build] [--number N, default: 25]

Reads Testing/Temporary/LastTest.log, which has the output of all tests: GoogleTest tells the time of each case, and
so does main() of harmos_runs.py. Seconds of a test that runs on several ranks are those of a clock.
"""

import argparse
import re
from pathlib import Path

GTEST = re.compile(r"\[       OK \] (\S+?)(?:, where .*)? \((\d+) ms\)$")
CASE = re.compile(r"seconds: ([0-9.]+) (\S+)$")
TEST = re.compile(r"\d+/\d+ Test: (\S+)$")
END = re.compile(r"Test time = +([0-9.]+) sec$")


def seconds(log):
    """([(seconds, test)], [(seconds, test, case)])"""
    tests, cases, test = [], [], None
    for line in log.splitlines():
        line = line.rstrip()
        if found := TEST.match(line):
            test = found[1]
        elif found := END.match(line):
            tests.append((float(found[1]), test))
        elif found := GTEST.search(line):
            cases.append((int(found[2]) / 1000, test, found[1]))
        elif found := CASE.search(line):
            cases.append((float(found[1]), test, found[2]))
    return tests, cases


def main():
    words = argparse.ArgumentParser(description="The dearest tests and cases of a run of CTest, in seconds.")
    words.add_argument("tree", nargs="?", default="build", type=Path)
    words.add_argument("--number", default=25, type=int)
    options = words.parse_args()
    log = (options.tree / "Testing/Temporary/LastTest.log").read_text(encoding="utf-8", errors="replace")
    tests, cases = seconds(log)
    print(f"{len(tests)} tests, {sum(one[0] for one in tests):.0f} s in all; the dearest:")
    for time, test in sorted(tests, reverse=True)[: options.number]:
        print(f"{time:8.1f} {test}")
    print(f"{len(cases)} cases, {sum(one[0] for one in cases):.0f} s in all; the dearest:")
    for time, test, case in sorted(cases, reverse=True)[: options.number]:
        print(f"{time:8.1f} {test}: {case}")


if __name__ == "__main__":
    main()
