# SPDX-License-Identifier: BSD-3-Clause
"""Models of CalculiX' own test suite: converted, solved, and compared with its results.

    calculix_models.py [NAME...] [--nlgeom] [--suite DIR] [--work DIR] [--np 1] [--output JSON] [--page MARKDOWN]
    calculix_models.py --render [--output JSON] [--page MARKDOWN]

Each model is converted by harmos-inp. What is converted is solved, and compared with the reference of the suite and
with ccx, which solves the same input with all displacements printed: displacements at each node, and the mean stresses
of the elements whose stresses the model prints. Differences are the largest one over the largest value. With
--nlgeom each step of each model has NLGEOM, and ccx alone is compared with.

The suite is that of Debian's package calculix-ccx-test. Exit status 1 if a model of those in scope does not agree; 77
where the suite, ccx or h5py are missing.
"""

import argparse
import gzip
import json
import re
import shutil
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "support"), str(HERE.parents[2] / "apps/tools/inp")]

import calculix_page  # noqa: E402
import calculix_results as results  # noqa: E402
import harmos_measure  # noqa: E402
import harmos_runs as runs  # noqa: E402

DOCUMENT = runs.SOURCE / "docs/calculix.json"
PAGE = runs.SOURCE / "docs/calculix.md"
SUITE = Path("/usr/share/doc/calculix-ccx-test/examples/test")
TOLERANCE = 1e-8  # of Harmos

# Procedures, elements and materials that Harmos does not have, or not yet: a model with one of them is out of scope.
OUTSIDE = {
    "dynamics and frequencies": """FREQUENCY; DYNAMIC; MODAL DYNAMIC; STEADY STATE DYNAMICS; COMPLEX FREQUENCY;
        BUCKLE; MODAL DAMPING; SUBSTRUCTURE GENERATE""",
    "heat, flow and fields": """HEAT TRANSFER; FLUID SECTION; FLUID SECTIONS; CFD; ELECTROMAGNETICS;
        COUPLED TEMPERATURE-DISPLACEMENT; UNCOUPLED TEMPERATURE-DISPLACEMENT; NO ANALYSIS""",
    "shells, beams, springs": """SHELL SECTION; BEAM SECTION; BEAM GENERAL SECTION; MEMBRANE SECTION; SPRING; DASHPOT;
        GAP; MASS; RIGID BODY; DISTRIBUTING COUPLING; MPC""",
    "inelastic materials": """CREEP; VISCO; HYPERELASTIC; HYPERFOAM; USER MATERIAL; DEFORMATION PLASTICITY;
        CYCLIC HARDENING""",
    "other procedures": "SENSITIVITY; RESTART; SUBMODEL; MODEL CHANGE; GREEN; CRACK PROPAGATION",
}
OUTSIDE = {
    " ".join(name.split()): reason for reason, names in OUTSIDE.items() for name in names.split(";")
}


OUTSIDE_LINES = (
    (r"^\*CHANGE ", "properties that change between steps"),
    (r"^\*INITIAL CONDITIONS.*TYPE *= *(STRESS|PLASTIC)", "initial stresses and strains"),
    (r"^\*BOUNDARY.*FIXED", "supports at deformed positions"),
    (r"P\dNP *,", "loads of user subroutines"),
    (r"^\*MEMBRANE *,", "words that are no keyword of CalculiX"),
)
TEMPERATURE = "depend on temperature"  # in a refusal


def unpacked(suite, directory):
    """The models of the suite, with their results, as plain files: Debian packs large ones."""
    directory.mkdir(parents=True, exist_ok=True)
    for path in sorted([*suite.glob("*.inp*"), *suite.glob("*.dat.ref*")]):
        plain = directory / path.name.removesuffix(".gz")
        if not plain.exists():
            plain.write_bytes(gzip.decompress(path.read_bytes()) if path.suffix == ".gz" else path.read_bytes())
    return sorted(directory.glob("*.inp"))


def with_nlgeom(sources, directory):
    """The same models, with finite deformations in all steps."""
    directory.mkdir(parents=True, exist_ok=True)
    for source in sources:
        text = re.sub(r"(?im)^(\*STEP\b(?!.*NLGEOM)[^\n\r]*)", r"\1, NLGEOM", text_of(source))
        (directory / source.name).write_text(text, encoding="utf-8")
        yield directory / source.name


def text_of(path):
    return path.read_text(encoding="utf-8", errors="replace") if path.exists() else ""


def outside(text):
    """Why a model is out of scope; "" if it is in."""
    keywords = re.findall(r"^\*([^*,\n][^,\n]*)", text, re.MULTILINE)
    reasons = [OUTSIDE.get(" ".join(keyword.upper().split())) for keyword in keywords]
    if any(reasons):
        return next(reason for reason in reasons if reason)
    if re.search(r"^\*ELEMENT.*TYPE *= *(T3D|B3|S[3-8]|M3D|DASH|SPRING|GAP)", text, re.M | re.I):
        return "shells, beams, springs"
    for pattern, reason in OUTSIDE_LINES:
        if re.search(pattern, text, re.MULTILINE | re.IGNORECASE):
            return reason
    return ""


def with_all_displacements(text):
    """The input, with the displacements of all nodes printed in each step, and a direct solver."""
    text = re.sub(r"(?im)^(\*STATIC.*?), *SOLVER *=[^,\n]*", r"\1", text)
    text = re.sub(r"(?im)^(\*NODE PRINT.*)$", r"**\1", text)
    lines, skip = [], False
    for line in text.splitlines():
        if line.startswith("***NODE PRINT") or line.upper().startswith("***NODE PRINT"):
            skip = True
            continue
        if skip and not line.startswith("*"):
            continue
        skip = False
        if re.match(r"(?i)\*END *STEP", line):
            lines += ["*NODE PRINT,NSET=NHARMOS,FREQUENCY=1000000,GLOBAL=YES", "U"]
        lines.append(line)
    first = next(k for k, line in enumerate(lines) if re.match(r"(?i)\*STEP", line))
    nodes = sorted(set(node_numbers(text)))
    sets = ["*NSET,NSET=NHARMOS"] + [f"{node}," for node in nodes]
    return "\n".join(lines[:first] + sets + lines[first:]) + "\n"


def node_numbers(text):
    inside = False
    for line in text.splitlines():
        if line.startswith("*"):
            inside = bool(re.match(r"(?i)\*NODE *(,|$)", line)) if not line.startswith("**") else inside
        elif inside and line.strip():
            yield int(line.split(",")[0])


def run_ccx(name, text, work):
    """What ccx prints, "" where it fails, and its seconds, of one run."""
    directory = work / "ccx" / name
    directory.mkdir(parents=True, exist_ok=True)
    (directory / f"{name}.inp").write_text(with_all_displacements(text), encoding="utf-8")
    begin = time.perf_counter()
    status, _, _ = runs.execute(["ccx", "-i", name], cwd=directory)
    seconds = time.perf_counter() - begin
    printed = directory / f"{name}.dat"
    return (text_of(printed) if status == 0 else ""), seconds


def prints_local_axes(text):
    """Whether nodes with a *TRANSFORM are printed in its axes, as they are unless the input says otherwise."""
    prints = re.findall(r"(?im)^\*NODE *PRINT(.*)$", text)
    return not all("GLOBAL=YES" in options.upper().replace(" ", "") for options in prints)


def in_global_axes(conversion, node, u):
    axes = conversion.axes(node)
    return u if axes is None else (axes.T @ u).tolist()


def solve(name, source, conversion, work, np_):
    """Runs a converted model; fields of its entry."""
    import inp_write

    directory = work / name
    directory.mkdir(parents=True, exist_ok=True)
    inp_write.write_mesh(conversion, directory / f"{name}.msh")
    inp_write.write_deck(conversion, directory / f"{name}.xml", f"{name}.msh")
    run = runs.run(
        directory / f"{name}.xml",
        {"Solver/Tolerance": TOLERANCE, "Output/Expert/Cell fields": "stress"},
        np=np_,
        output=directory / "out",
        program="harmos",
    )
    if run.returncode != 0:
        errors = re.findall(r"(?m)^error: (.*)$", run.stderr)
        return {"status": "fails", "reason": errors[0][:300] if errors else f"status {run.returncode}"}
    result = results.Result(sorted((directory / "out").glob("result*.vtkhdf"))[-1], conversion)
    ours = result.displacements()
    reference = results.last_displacements(text_of(source.with_suffix(".dat.ref")))
    if prints_local_axes(text_of(source)):
        reference = {node: in_global_axes(conversion, node, u) for node, u in reference.items()}
    printed, ccx_seconds = run_ccx(name, text_of(source), work)
    entry = {
        "nodes": len(conversion.parts.body_of_node),
        "seconds": run.summary["seconds"]["total"],
        "ccx_seconds": round(ccx_seconds, 3),
        "notes": conversion.notes,
    }
    for field, theirs in (("reference", reference), ("ccx", results.last_displacements(printed))):
        apart, node, compared = results.difference(ours, theirs)
        if compared:
            entry[field] = {"difference": float(f"{apart:.3g}"), "node": node, "nodes": compared}
    stresses = results.last_stresses(printed, conversion.model)
    if stresses:
        apart, element, compared = results.stress_difference(result, stresses)
        entry["stress"] = {"difference": float(f"{apart:.3g}"), "element": element, "elements": compared}
    return entry


def tolerance_of(conversion):
    """Six digits are printed after the first. Surfaces that are coupled have other discretisations there, and ccx
    expands axisymmetric elements to a wedge of two degrees with straight sides."""
    if conversion.physics == "axisymmetric":
        return 5e-4
    return 1e-2 if conversion.effects.get("Tie") or conversion.effects.get("Contact") else 1e-4


def entry_of(source, work, np_):
    import inp_deck
    import inp_file
    import inp_model
    import inp_write

    name, text = source.stem, text_of(source)
    entry = {"name": name, "outside": outside(text)}
    try:
        conversion = inp_deck.Conversion(inp_model.read_model(inp_file.read(source)), name)
    except inp_file.InpError as error:
        if TEMPERATURE in error.faults[0]:
            entry["outside"] = entry["outside"] or "moduli that depend on temperature"
        return {**entry, "status": "refused", "reason": error.faults[0]}
    if entry["outside"]:
        return {**entry, "status": "converted"}
    conversion.deck_bodies = inp_write.deck_of(conversion, "")["harmos"]["Bodies"]
    entry.update(solve(name, source, conversion, work, np_))
    if "status" in entry:
        return entry
    # Results of the suite that come from an iterative solver are not exact: ccx solves anew, directly.
    chief = entry.get("ccx", entry.get("reference"))
    entry["tolerance"] = tolerance_of(conversion)
    agree = chief and max(chief["difference"], entry.get("stress", chief)["difference"]) <= entry["tolerance"]
    entry["status"] = "agrees" if agree else "differs"
    return entry


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--nlgeom", action="store_true")
    parser.add_argument("--suite", type=Path, default=SUITE)
    parser.add_argument("--work", type=Path, help="where decks and results are left")
    parser.add_argument("--np", type=int, default=1)
    parser.add_argument("--output", type=Path, metavar="JSON")
    parser.add_argument("--page", type=Path, metavar="MARKDOWN")
    parser.add_argument("--render", action="store_true", help="measure nothing")
    return parser.parse_args()


def missing():
    found = [] if shutil.which("ccx") else ["calculix-ccx"]
    for module in ("numpy", "h5py"):
        try:
            __import__(module)
        except ImportError:
            found.append(f"python3-{module}")
    return found


def main():
    given = arguments()
    if given.render:
        document = json.loads((given.output or DOCUMENT).read_text(encoding="utf-8"))
        (given.page or PAGE).write_text(calculix_page.page(document), encoding="utf-8")
        return 0
    lacking = missing() + ([] if given.suite.is_dir() else ["calculix-ccx-test"])
    if lacking:
        print(f"SKIP: Debian's {' and '.join(lacking)} must be installed", file=sys.stderr)
        return runs.SKIPPED
    work = given.work or Path(tempfile.mkdtemp(prefix="harmos_calculix_"))
    sources = [
        source
        for source in unpacked(given.suite, work / "suite")
        if not given.names or source.stem in given.names
    ]
    if given.nlgeom:
        sources = list(with_nlgeom(sources, work / "nlgeom"))
    entries = []
    for source in sources:
        entries.append(entry_of(source, work, given.np))
        if not entries[-1]["outside"]:
            print(calculix_page.line(entries[-1]), flush=True)
    document = {"benchmark": "calculix_models", "harmos": harmos_measure.version(), "ranks": given.np, "runs": entries}
    if given.output or not given.names:
        (given.output or DOCUMENT).write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8")
    if given.page or not given.names:
        (given.page or PAGE).write_text(calculix_page.page(document), encoding="utf-8")
    inside = [entry for entry in entries if not entry["outside"]]
    print(f"{sum(e['status'] == 'agrees' for e in inside)} of {len(inside)} in scope agree")
    return 0 if all(entry["status"] == "agrees" for entry in inside) else 1


if __name__ == "__main__":
    sys.exit(main())
