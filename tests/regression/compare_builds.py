# SPDX-License-Identifier: BSD-3-Clause
"""Two builds of Harmos come to the same results, to the last bit.

    compare_builds.py REVISION             build that revision and compare it with the build there is
    compare_builds.py REVISION --old DIR   with the build of that revision in DIR, where there is one

A change that is to change no behaviour is compared with the revision before it: every deck of the
applications, on one rank, and the results of unit_results/unit_results.cpp, which is compiled
against both. Compared are all numbers of summary.json but those of time and memory, iterations.csv
but for its seconds, every dataset of result.vtkhdf, and what unit_results prints. What only the newer
one tells is named, and is no difference.

Takes a build, and some minutes; no part of CI.
"""

import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402

# What differs from run to run.
MEASURED = {"seconds", "peak_memory_mib", "git", "version", "dual_operator_mib", "bytes"}
APPLICATIONS = ("signorini", "fiber_composite", "harmos")
HERE = Path(__file__).resolve().parent


def call(*command, **more):
    subprocess.run([str(word) for word in command], check=True, **more)


def built(revision, directory, jobs):
    """A build of a revision without tests; its sources stay, since it is to be installed."""
    source, build = directory / "source", directory / "build"
    call("git", "clone", "--quiet", "--no-checkout", runs.SOURCE, source)
    call("git", "-C", source, "checkout", "--quiet", "--detach", revision)
    call("cmake", "-S", source, "-B", build, "-DHARMOS_ENABLE_TESTS=OFF",
         "-DHARMOS_ENABLE_GMSH=ON", stdout=subprocess.DEVNULL)
    call("cmake", "--build", build, "--parallel", jobs, stdout=subprocess.DEVNULL)
    return build


def without_measured(value):
    if isinstance(value, dict):
        return {k: without_measured(v) for k, v in value.items() if k not in MEASURED}
    return [without_measured(v) for v in value] if isinstance(value, list) else value


def history(path):
    with open(path, newline="", encoding="utf-8") as file:
        return [{k: v for k, v in row.items() if k != "seconds"} for row in csv.DictReader(file)]


def datasets(path):
    import h5py

    found = {}

    def visit(name, item):
        if isinstance(item, h5py.Dataset):
            found[name] = (item.shape, str(item.dtype), item[()].tobytes())

    with h5py.File(path, "r") as file:
        file.visititems(visit)
    return found


def results_of(build, deck, directory):
    """What a run leaves behind, comparable; a run that fails is one that says why."""
    program = build / "bin" / deck.parents[1].name
    status, _, errors = runs.execute([program, deck, "--output", directory, "--quiet"])
    result = {"exit status": status, "errors": errors}
    if (directory / "summary.json").exists():
        text = (directory / "summary.json").read_text(encoding="utf-8")
        result["summary.json"] = without_measured(json.loads(text))
    if (directory / "iterations.csv").exists():
        result["iterations.csv"] = history(directory / "iterations.csv")
    if (directory / "result.vtkhdf").exists():
        result["result.vtkhdf"] = datasets(directory / "result.vtkhdf")
    return result


NEW = set()  # what only the newer build tells


def first_difference(one, other, place=""):
    if isinstance(one, dict) and isinstance(other, dict):
        NEW.update(f"{place}/{key}" for key in other if key not in one)
        for key in one:
            if key not in other:
                return f"{place}/{key}: only in the older one"
            found = first_difference(one[key], other[key], f"{place}/{key}")
            if found:
                return found
        return None
    if isinstance(one, list) and isinstance(other, list) and len(one) == len(other):
        for k, (a, b) in enumerate(zip(one, other)):
            found = first_difference(a, b, f"{place}[{k}]")
            if found:
                return found
        return None
    # Text of equal numbers may differ in nothing: both builds print in the same way.
    return None if one == other else f"{place}: {str(one)[:100]} -> {str(other)[:100]}"


def unit_results(build, directory):
    """What unit_results prints, compiled against an installed tree of a build."""
    prefix = directory / "prefix"
    call("cmake", "--install", build, "--prefix", prefix, stdout=subprocess.DEVNULL)
    own = directory / "unit_results"
    call("cmake", "-S", HERE / "unit_results", "-B", own, f"-DCMAKE_PREFIX_PATH={prefix}",
         f"-DEXAMPLES={runs.SOURCE / 'docs' / 'examples'}", "-DCMAKE_BUILD_TYPE=Release",
         stdout=subprocess.DEVNULL)
    call("cmake", "--build", own, stdout=subprocess.DEVNULL)
    status, printed, errors = runs.execute([own / "unit_results"])
    if status != 0:
        sys.exit(f"unit_results of {build}: exit status {status}\n{errors}")
    return printed.splitlines()


def compared(name, one, other):
    found = first_difference(one, other)
    if not found and isinstance(one, dict) and one["exit status"] != 0:
        found = f"neither of them solves it: {one['errors'][:200]}"
    print(f"{'DIFFERENT' if found else 'equal'}  {name}{': ' + found if found else ''}", flush=True)
    return not found


def is_in(revision, path):
    name = f"{revision}:{path.relative_to(runs.SOURCE)}"
    found = subprocess.run(["git", "-C", str(runs.SOURCE), "cat-file", "-e", name],
                           stderr=subprocess.DEVNULL, check=False)
    return found.returncode == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("revision")
    parser.add_argument("--old", type=Path, help="a build of that revision")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    options = parser.parse_args()
    runs.TIMEOUT = 1200
    with tempfile.TemporaryDirectory(prefix="harmos_compare_") as scratch:
        scratch = Path(scratch)
        old = options.old or built(options.revision, scratch, options.jobs)
        new = runs.BINARY
        decks = [deck for name in APPLICATIONS
                 for deck in sorted((runs.SOURCE / "apps" / name / "decks").glob("*.xml"))
                 if is_in(options.revision, deck)]
        equal = []
        for deck in decks:
            outputs = [scratch / which / deck.parents[1].name / deck.stem for which in ("old", "new")]
            one, other = (results_of(b, deck, o) for b, o in zip((old, new), outputs))
            rows = len(one.get("iterations.csv", []))
            equal.append(compared(f"{deck.parents[1].name}/{deck.name} ({rows} iterations)", one, other))
        lines = [unit_results(b, scratch / f"unit_{which}") for b, which in ((old, "old"), (new, "new"))]
        equal.append(compared(f"unit_results ({len(lines[0])} lines)", *lines))
    print(f"{sum(equal)} of {len(equal)} equal; told by the newer one alone: {sorted(NEW) or 'nothing'}")
    return 0 if all(equal) else 1


if __name__ == "__main__":
    sys.exit(main())
