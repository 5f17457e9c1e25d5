# SPDX-License-Identifier: BSD-3-Clause
"""What each rescue and each constant of the QP layer is worth: one at a time switched off, or changed threefold.

    ablation.py --build-dir DIR --output LINES [--families random friction ...] [--random 0:1000] [--friction 0:300]
                [--only KNOB...] [--jobs 2]
    ablation.py --render LINES... [--json docs/ablation.json] [--page docs/ablation.md]

The sources are copied into DIR, with a knob in the place of each constant and rescue (knobs.py), and built there. A
scene is run as it is, and again for each knob that it asks for, and for each of its values: what it does not ask for
makes no difference. LINES gets a line of JSON a run; a scene that is there, with all knobs, is not run again. Counts
of applications do not depend on what else the machine does, so that all cores can be used; a run that takes more than
some minutes is given up, and says so.

Families: random scenes without and with friction; decks of harmos, signorini and fiber_composite; friction products:
plate, composites and real bodies, with coefficients from slip to stick; adhesion: a composite and a delamination; real
bodies of tetrahedra, cut in two ways.
"""

import argparse
import concurrent.futures
import json
import math
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import textwrap
from pathlib import Path

HERE = Path(__file__).resolve().parent
TESTS = HERE.parents[1]
sys.path[:0] = [str(HERE), str(TESTS / "support"), str(TESTS / "verification"), str(TESTS / "verification/oracles")]

import harmos_runs as runs  # noqa: E402
import knobs  # noqa: E402

SECONDS = 300  # of a run: some wander for good when a rescue is off
FAMILIES = ("random", "friction", "decks", "friction products", "adhesion", "real bodies")
PROGRAMS = ("harmos", "signorini", "fiber_composite", "ablation_scenes")


def prepared(directory, jobs):
    """The copy with knobs, built. @return the values of each knob to be tried."""
    tree, build = directory / "source", directory / "build"
    listed = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard", "-z"], cwd=runs.SOURCE, check=True, capture_output=True
    ).stdout.decode()
    with tempfile.TemporaryDirectory(dir=directory) as fresh:
        for name in filter(None, listed.split("\0")):
            place = Path(fresh) / name
            place.parent.mkdir(parents=True, exist_ok=True)
            if (runs.SOURCE / name).is_file():
                shutil.copy2(runs.SOURCE / name, place)
        trials = knobs.planted(Path(fresh))
        # Found where the package has its headers, by the program too.
        here = Path(fresh) / HERE.relative_to(runs.SOURCE) / "Harmos_Tuning.hpp"
        here.rename(Path(fresh) / "packages/qp/src/kernels/Harmos_Tuning.hpp")
        copy_changed(Path(fresh), tree)
    subprocess.run(
        ["cmake", "-S", tree, "-B", build, "-DCMAKE_BUILD_TYPE=Release", "-DHARMOS_ENABLE_TESTS=ON",
         "-DHARMOS_ENABLE_GMSH=ON"],
        check=True, stdout=subprocess.DEVNULL,
    )
    subprocess.run(["cmake", "--build", build, "-j", str(jobs), "--target", *PROGRAMS], check=True)
    return trials


def copy_changed(fresh, tree):
    """What is the same keeps its time, and is not built again; what is gone goes."""
    for place in (path for path in tree.rglob("*") if path.is_file()):
        if not (fresh / place.relative_to(tree)).is_file():
            place.unlink()
    for place in (path for path in fresh.rglob("*") if path.is_file()):
        target = tree / place.relative_to(fresh)
        if not target.is_file() or target.read_bytes() != place.read_bytes():
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(place, target)


def decks(directory):
    """Name, program, deck and settings of each scene of the families that programs run."""
    import beams
    import real_bodies
    import test_friction_products as products

    for program in ("harmos", "signorini", "fiber_composite"):
        for deck in sorted((runs.SOURCE / "apps" / program / "decks").glob("*.xml")):
            yield "decks", f"{program}/{deck.stem}", program, deck, {}
    frictions = [products.given(bound) for bound in (1e6, 1e7, 3e7, 1e8)]
    frictions += [products.coulomb(value) for value in (0.3, 1.0, 2.0)]
    for k, friction in enumerate(frictions):
        deck = directory / f"plate{k}.xml"
        deck.write_text(products.plate(friction), encoding="utf-8")
        yield "friction products", f"plate {friction}", "harmos", deck, {}
    six = {"Model/Columns": 6, "Model/Rows": 6}
    for name, values in (("Slip bound", (1e-3, 3e-3, 5e-3, 8e-3)), ("Coefficient of friction", (0.1, 0.3, 0.6, 1.0))):
        for value in values:
            setting = {f"Model/{name}": value}
            yield "friction products", f"composite {setting}", "fiber_composite", runs.COMPOSITE, six | setting
    for key in ("half-ball", "ball-on-block"):
        for k, friction in enumerate(
            [products.given(b) for b in (1e-4, 3e-3, 3e-2)] + [products.coulomb(c) for c in (0.1, 0.6, 3.0)]
        ):
            place = directory / f"{key}{k}"
            place.mkdir()
            deck = real_bodies.write_deck(place, key, True, scale=2.0, drag=0.02, friction=friction)
            yield "friction products", f"{key} {friction}", "harmos", deck, real_bodies.cut(key, 24)
    debonding = runs.SOURCE / "apps/fiber_composite/decks/debonding.xml"
    yield "adhesion", "composite 4x4", "fiber_composite", debonding, {"Model/Columns": 4, "Model/Rows": 4}
    deck = directory / "cantilever.xml"
    deck.write_text(beams.double_cantilever(beams.Specimen(), 2.0, 10, per_length=0.5), encoding="utf-8")
    yield "adhesion", "double cantilever", "harmos", deck, {}
    for key in real_bodies.BODIES:
        for contact in (False, True):
            place = directory / f"{key}{contact}"
            place.mkdir()
            deck = real_bodies.write_deck(place, key, contact, scale=1.5)
            for parts in (24, 96):
                yield "real bodies", f"{key} {contact} {parts}", "harmos", deck, real_bodies.cut(key, parts)


def run_program(build, program, deck, settings, knob=None, value=None):
    """A run of a program. @return what became of it, and the knobs that it asked for."""
    with tempfile.TemporaryDirectory() as place:
        asked, out = Path(place) / "asked", Path(place) / "out"
        environment = {**os.environ, "HARMOS_TUNE_ASKED": str(asked)}
        if knob:
            environment["HARMOS_TUNE"] = f"{knob}={value!r}"
        command = [build / "bin" / program, deck, "--output", out]
        for name, setting in {**settings, "Output/Fields": False}.items():
            command += ["--set", f"{name}={str(setting).lower() if isinstance(setting, bool) else setting}"]
        try:
            done = subprocess.run(command, env=environment, capture_output=True, timeout=SECONDS, check=False)
            summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
        except subprocess.TimeoutExpired:
            return failed(f"given up after {SECONDS} s"), []
        except (OSError, ValueError):
            return failed(f"exit status {done.returncode}: {done.stderr.decode()[-200:]}"), []
        line = {
            "converged": summary.get("converged", False),
            "applications": summary.get("hessian_applications", 0),
            "reason": "" if summary.get("converged") else str(summary.get("reason", ""))[:60],
            "energy": summary.get("energy"),
        }
        return line, asked.read_text(encoding="utf-8").split("\n") if asked.is_file() else []


def failed(reason):
    return {"converged": False, "applications": 0, "reason": reason}


def try_deck(build, item, trials):
    family, name, program, deck, settings = item
    place = {"family": family, "scene": name, "solvable": True}
    base, asked = run_program(build, program, deck, settings)
    lines = [place | base]
    for knob in asked:
        for value in trials.get(knob, []):
            line, _ = run_program(build, program, deck, settings, knob, value)
            lines.append(place | line | {"knob": knob, "value": value})
    return lines


def try_seed(build, family, seed, trials):
    with tempfile.TemporaryDirectory() as place:
        table, out = Path(place) / "trials.json", Path(place) / "lines"
        table.write_text(json.dumps(trials), encoding="utf-8")
        command = [build / "tests/bin/ablation_scenes", f"--{family}", f"{seed}:{seed + 1}", "--trials", table,
                   "--output", out]
        try:
            done = subprocess.run(command, cwd=place, capture_output=True, timeout=len(trials) * SECONDS, check=False)
            status = f"exit status {done.returncode}: {done.stderr.decode()[-200:]}" if done.returncode else ""
        except subprocess.TimeoutExpired:
            status = "given up"
        lines = whole_lines(out) if out.is_file() else []
        if status:
            lines.append({"family": family, "scene": seed, "knob": "?", "value": 0.0, **failed(status)})
        return lines


def measure(given):
    directory = Path(given.build_dir).resolve()
    directory.mkdir(parents=True, exist_ok=True)
    trials = prepared(directory, given.jobs)
    if given.only:
        trials = {name: trials[name] for name in given.only}
    known = {}
    if Path(given.output).is_file():
        for line in read([given.output]):
            if "complete" in line:
                known.setdefault((line["family"], line["scene"]), set()).update(line["complete"])
    build = directory / "build"

    def missing(family, scene):
        """Knobs that this scene has not been tried with."""
        return {name: values for name, values in trials.items() if name not in known.get((family, scene), set())}

    with tempfile.TemporaryDirectory() as place, concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
        waiting = {}
        for item in decks(Path(place)):
            if item[0] in given.families and (left := missing(*item[:2])):
                waiting[pool.submit(try_deck, build, item, left)] = (*item[:2], left)
        for family in ("random", "friction"):
            first, last = map(int, getattr(given, family).split(":"))
            for seed in range(first, last) if family in given.families else ():
                if left := missing(family, seed):
                    waiting[pool.submit(try_seed, build, family, seed, left)] = (family, seed, left)
        for count, task in enumerate(concurrent.futures.as_completed(waiting), 1):
            family, scene, left = waiting[task]
            lines = task.result()
            if any(line.get("knob") == "?" or ("knob" not in line and line["applications"] == 0) for line in lines):
                print(f"{family}, {scene}: {lines[-1].get('reason')}", file=sys.stderr)
            with open(given.output, "a", encoding="utf-8") as file:
                file.writelines(json.dumps(line) + "\n" for line in lines)
                file.write(json.dumps({"family": family, "scene": scene, "complete": sorted(left)}) + "\n")
            print(f"{count} of {len(waiting)} scenes", flush=True)


def whole_lines(path):
    """Of JSON; a run that was killed may have left half of one."""
    lines = []
    for line in Path(path).read_text(encoding="utf-8").splitlines():
        try:
            lines.append(json.loads(line))
        except ValueError:
            print(f"{path}: a line is not whole", file=sys.stderr)
    return lines


def read(paths):
    return [line for path in paths for line in whole_lines(path)]


def percentile(values, share):
    return sorted(values)[max(0, math.ceil(share * len(values)) - 1)]


def is_good(line):
    """An answer where there is one; a proof where there is none."""
    return line["converged"] if line.get("solvable", True) else line.get("reason", "").startswith("infeasible")


def is_wrong(base, line):
    """An answer where there is none, or another one, by a hundredth of the energy. With friction there may be several."""
    if not line["converged"] or not base.get("solvable", True):
        return line["converged"]
    one, other = base.get("energy"), line.get("energy")
    return (base["converged"] and "friction" not in base["family"] and one is not None and other is not None
            and abs(one - other) > 0.01 * abs(one))


def row(base, changed):
    """What a knob's value does to the scenes of a family that ask for it."""
    pairs = [(base[scene], line) for scene, line in changed.items() if scene in base]
    both = [(a["applications"], b["applications"]) for a, b in pairs if a["converged"] and b["converged"]]
    ratios = [b / a for a, b in both if a > 0]
    result = {
        "asked": len(pairs),
        "differ": sum(a["applications"] != b["applications"] or is_good(a) != is_good(b) for a, b in pairs),
        "lost": sum(is_good(a) and not is_good(b) for a, b in pairs),
        "won": sum(is_good(b) and not is_good(a) for a, b in pairs),
        "wrong": sum(is_wrong(a, b) for a, b in pairs),
    }
    if ratios:
        result |= {
            "median": round(statistics.median(ratios), 3),
            "share_95": round(percentile(ratios, 0.95), 3),
            "largest": round(max(ratios), 2),
            "total": round(sum(b for _, b in both) / max(1, sum(a for a, _ in both)), 3),
        }
    return result


def table_of(lines):
    """Rows by knob, value and family; and what scenes take as they are."""
    base, changed = {}, {}
    for line in lines:
        if "complete" in line:
            continue
        place = base if "knob" not in line else changed.setdefault((line["knob"], line["value"]), {})
        place.setdefault(line["family"], {})[line["scene"]] = line
    families = {}
    for family, scenes in base.items():
        counts = [line["applications"] for line in scenes.values() if line["converged"]]
        families[family] = {
            "scenes": len(scenes),
            "converged": len(counts),
            "good": sum(map(is_good, scenes.values())),
            "median": statistics.median(counts or [0]),
            "share_95": percentile(counts or [0], 0.95),
            "largest": max(counts, default=0),
        }
    rows = [
        {"knob": knob, "value": value, "family": family, **row(base[family], scenes)}
        for (knob, value), by_family in sorted(changed.items())
        for family, scenes in sorted(by_family.items())
        if family in base
    ]
    return {"families": families, "rows": rows}


def meaning_of():
    return {place.knob: place.meaning for place in knobs.RESCUES + knobs.NUMBERS}


def text_of(document):
    """The page."""
    lines = [
        "# What rescues and constants of the QP layer are worth",
        "",
        "Each is switched off, or changed to three times its value and to a third, alone. A row counts the scenes of a",
        "family that ask for it: how many come to another number of applications or to another end; how many end well",
        "no more (lost) or only so (won), which is with an answer, or with a proof that there is none; how many end with a",
        "wrong answer; and the applications beside those without the change, of the scenes that converge both ways. A",
        "change that no scene notices has no row. Rescues that the sources do not have any more were deleted by their",
        "rows. Constants were tried on fewer scenes with friction than rescues. Written by",
        "`tests/performance/ablation/ablation.py` from `ablation.json`.",
        "",
        "| Family | Scenes | End well | Median | 95 % | Largest |",
        "|---|---|---|---|---|---|",
    ]
    for family, item in document["families"].items():
        lines.append(
            f"| {family} | {item['scenes']} | {item['good']} | {item['median']:g} | {item['share_95']} "
            f"| {item['largest']} |"
        )
    for title, is_here in (("Rescues", lambda name: name.startswith("off: ")), ("Constants", lambda name: not name.startswith("off: "))):
        lines += ["", f"## {title}", "", "| | Value | Family | Asked | Differ | Lost | Won | Wrong | Median | 95 % | Largest | All |",
                  "|---|---|---|---|---|---|---|---|---|---|---|---|"]
        for item in document["rows"]:
            if is_here(item["knob"]) and item["differ"] > 0:
                ratios = " | ".join(f"{item[key]:g}" if key in item else "" for key in ("median", "share_95", "largest", "total"))
                lines.append(
                    f"| {item['knob'].removeprefix('off: ')} | {'off' if is_switch(item) else format(item['value'], '.3g')} "
                    f"| {item['family']} | {item['asked']} | {item['differ']} | {item['lost']} | {item['won']} "
                    f"| {item['wrong']} | {ratios} |"
                )
    noticed = {item["knob"] for item in document["rows"] if item["differ"] > 0}
    asked = {item["knob"] for item in document["rows"]}
    lines += ["", "## Unnoticed"]
    unnoticed = ", ".join(sorted(asked - noticed)) or "none"
    never = ", ".join(sorted(set(document["knobs"]) - asked)) or "none"
    for text in (f"Asked for, and no scene came to another count: {unnoticed}.", f"Never asked for: {never}."):
        lines += ["", *textwrap.wrap(text, 118)]
    return "\n".join(lines) + "\n"


def is_switch(item):
    return item["knob"].startswith("off: ")


def render(given):
    document = {"benchmark": "ablation", **table_of(read(given.render)), "knobs": all_knobs()}
    Path(given.json).write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    Path(given.page).write_text(text_of(document), encoding="utf-8")
    print(f"wrote {given.json} and {given.page}")


def all_knobs():
    with tempfile.TemporaryDirectory() as place:
        shutil.copytree(runs.SOURCE / knobs.PACKAGE, Path(place) / knobs.PACKAGE)
        return sorted(knobs.planted(Path(place)))


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build-dir")
    parser.add_argument("--output", default="ablation.lines")
    parser.add_argument("--families", nargs="+", choices=FAMILIES, default=list(FAMILIES))
    parser.add_argument("--random", default="0:1000")
    parser.add_argument("--friction", default="0:300")
    parser.add_argument("--only", nargs="+", metavar="KNOB")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--render", nargs="+", metavar="LINES")
    parser.add_argument("--json", default=runs.SOURCE / "docs/ablation.json")
    parser.add_argument("--page", default=runs.SOURCE / "docs/ablation.md")
    parser.add_argument("--list", action="store_true", help="the knobs; nothing is built")
    return parser.parse_args()


def main():
    given = arguments()
    if given.list:
        print("\n".join(all_knobs()))
    elif given.render:
        render(given)
    else:
        measure(given)
    return 0


if __name__ == "__main__":
    sys.exit(main())
