# SPDX-License-Identifier: BSD-3-Clause
"""Measures the headline figures; writes docs/headline.json, docs/headline.md and the README's sentence.

    headline.py [--build DIR] [--runs 3]      measure; write docs/headline.{json,md} and the README
    headline.py --only NAME... [--output JSON] [--page FILE]      some cases; writes only the files named
    headline.py --quick [--output JSON] [--page FILE]             tiny forms of all cases, a smoke test
    headline.py --render                      measure nothing; page and README from the JSON
    headline.py --list

Runs have two ranks. Seconds and memory are medians; the JSON also has least and most. A case that
needs more memory than is free is skipped; JSON and page say so. Exit status 1 if a case failed,
did not converge or exceeded its memory limit; times are never judged.
"""

import argparse
import datetime
import difflib
import json
import os
import platform
import re
import statistics
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "support")]

import harmos_measure  # noqa: E402
import harmos_runs as runs  # noqa: E402
import headline_page  # noqa: E402
from headline_cases import CASES  # noqa: E402

DOCUMENT = runs.SOURCE / "docs/headline.json"
PAGE = runs.SOURCE / "docs/headline.md"
README = runs.SOURCE / "README.md"


def first_match(pattern, path, default):
    """The first group of a pattern in a file; the default if there is no such file or match."""
    try:
        found = re.search(pattern, Path(path).read_text(encoding="utf-8"), re.M)
    except OSError:
        found = None
    return found.group(1).strip() if found else default


def compiler():
    """Name, version and build type, as CMake knows them."""
    name, version = "unknown", ""
    for file in (runs.BINARY / "CMakeFiles").glob("*/CMakeCXXCompiler.cmake"):
        name = first_match(r'^set\(CMAKE_CXX_COMPILER_ID "(.*)"\)', file, name)
        version = first_match(r'^set\(CMAKE_CXX_COMPILER_VERSION "(.*)"\)', file, version)
    kind = first_match(r"^CMAKE_BUILD_TYPE:\w+=(.*)$", runs.BINARY / "CMakeCache.txt", "")
    return " ".join(filter(None, (name, version, kind)))


def memory_mib(field):
    """A field of /proc/meminfo; None where there is no such file."""
    kib = first_match(rf"^{field}:\s*(\d+) kB", "/proc/meminfo", None)
    return None if kib is None else int(kib) // 1024


def machine():
    return {
        "processor": first_match(r"^model name\s*:\s*(.*)$", "/proc/cpuinfo", platform.machine()),
        "cores": os.cpu_count(),
        "memory_mib": memory_mib("MemTotal"),
        "load": round(os.getloadavg()[0], 2),
    }


def spread(values, rounded):
    return {
        "median": rounded(statistics.median(values)),
        "least": rounded(min(values)),
        "most": rounded(max(values)),
    }


def four_digits(value):
    return float(f"{value:.4g}")


def from_theory(results):
    """Relative differences of the results from Hertz' theory."""
    return {
        name: float(f"{value / results[f'{name}_theory'] - 1.0:.3g}")
        for name, value in results.items()
        if results.get(f"{name}_theory")
    }


def figures(summaries):
    """The figures of a case that ran, for the JSON."""
    last = summaries[-1]
    return {
        "unknowns": last["primal_dimension"],
        "multipliers": last["dual_dimension"],
        "inequalities": last["inequalities"],
        "subdomains": last["subdomains"],
        "factorizations": last["distinct_local_factorizations"],
        "tolerance": last["tolerance"],
        "converged": all(summary["converged"] for summary in summaries),
        "solver": last["solver"],
        # Repeated runs do the same steps. If they ever differ, the largest count is reported.
        "products": max(summary["hessian_applications"] for summary in summaries),
        "seconds_total": spread([s["seconds"]["total"] for s in summaries], four_digits),
        "seconds_solve": spread([s["seconds"]["solve"] for s in summaries], four_digits),
        "peak_memory_mib": spread([s["peak_memory_mib"] for s in summaries], round),
        "from_theory": from_theory(last["results"]),
    }


def measure(case, given):
    """The entry of a case in the JSON."""
    sets = {**case.sets, **(case.tiny if given.quick else {})}
    entry = {
        "name": case.name,
        "title": case.title,
        "group": case.group,
        "program": case.program,
        "deck": case.deck,
        "set": sets,
        "memory_limit_mib": case.limit_mib,
        "problem": None,
    }
    free = memory_mib("MemAvailable")
    if free is not None and free < case.needs_mib and not given.quick:
        entry["problem"] = f"skipped: needs {case.needs_mib} MiB of free memory, {free} MiB are free"
        return entry
    try:
        summaries = harmos_measure.repeated(
            given.runs, runs.SOURCE / case.deck, sets, given.np, case.program
        )
    except (harmos_measure.RunFailed, AssertionError) as error:  # the latter: the time limit
        print(error, file=sys.stderr)
        entry["problem"] = "failed: see the log of the measurement"
        return entry
    return {**entry, **figures(summaries)}


def line(entry):
    if entry["problem"]:
        return f"{entry['name']}: {entry['problem']}"
    total, solve = entry["seconds_total"], entry["seconds_solve"]
    return (
        f"{entry['name']}: {entry['unknowns']}/{entry['multipliers']} "
        f"({entry['inequalities']} inequalities), {entry['products']} applications, "
        f"{total['median']} s [{total['least']}, {total['most']}], solving {solve['median']} s, "
        f"{entry['peak_memory_mib']['median']} MiB"
    )


def is_within_limits(entry):
    """Converged, within its memory limit; or skipped, and then without figures in the README."""
    if entry["problem"]:
        return entry["problem"].startswith("skipped")
    limit = entry["memory_limit_mib"]
    return entry["converged"] and (limit is None or entry["peak_memory_mib"]["most"] < limit)


def measured(cases, given):
    document = {
        "benchmark": "headline",
        "harmos": harmos_measure.version(),
        "ranks": given.np,
        "repetitions": given.runs,
        "quick": given.quick,
        "date": datetime.date.today().isoformat(),
        "machine": machine(),
        "compiler": compiler(),
        "runs": [],
    }
    for case in cases:
        entry = measure(case, given)
        document["runs"].append(entry)
        print(line(entry), flush=True)
    return document


def write(path, text):
    Path(path).write_text(text, encoding="utf-8")
    print(f"wrote {path}")


def write_readme(document):
    try:
        text = headline_page.with_block(README.read_text(encoding="utf-8"), document)
    except headline_page.Incomplete as error:
        print(f"README.md stays as it is: {error}", file=sys.stderr)
        return False
    write(README, text)
    return True


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--build", type=Path, help="build tree; build, or HARMOS_BINARY_DIR")
    parser.add_argument("--runs", type=int, default=3, help="repetitions of each case")
    parser.add_argument("--np", type=int, default=2)
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME")
    parser.add_argument("--quick", action="store_true", help="tiny forms of the cases, one run each")
    parser.add_argument("--render", action="store_true", help="measure nothing")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--output", type=Path, metavar="JSON")
    parser.add_argument("--page", type=Path)
    given = parser.parse_args()
    for name in given.only:
        if name not in CASES:
            near = difflib.get_close_matches(name, CASES, 1)
            hint = f"; did you mean {near[0]}?" if near else ""
            parser.error(f"there is no case {name}{hint} (--list shows them)")
    if given.runs < 1 or given.np < 1:
        parser.error("--runs and --np are at least 1")
    if given.build:
        runs.BINARY = given.build.resolve()
    if given.quick:
        given.runs = 1
    return given


def main():
    runs.TIMEOUT = 3600
    given = arguments()
    if given.list:
        for case in CASES.values():
            print(f"{case.name:22} {case.title}")
        return 0
    # The published figures are those of one measurement of all cases.
    whole = not given.only and not given.quick
    if given.render:
        document = json.loads((given.output or DOCUMENT).read_text(encoding="utf-8"))
    else:
        document = measured([CASES[name] for name in given.only or CASES], given)
        if whole or given.output:
            write(given.output or DOCUMENT, headline_page.as_json(document))
    if whole or given.page:
        write(given.page or PAGE, headline_page.page(document))
    good = all(is_within_limits(entry) for entry in document["runs"])
    if whole and not given.output and not given.page:
        good = write_readme(document) and good
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
