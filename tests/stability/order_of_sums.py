# SPDX-License-Identifier: BSD-3-Clause
"""Do the tests pass on other processors? Runs those that are not long with the kernels of each that this one can take.

    python3 tests/stability/order_of_sums.py                        all kernels, all tests
    python3 tests/stability/order_of_sums.py --list                 the kernels; nothing is run
    python3 tests/stability/order_of_sums.py --only Haswell -R qp   some; what is left goes to ctest

Processors add up in different orders: OpenBLAS has kernels for each kind, Harmos for those with AVX2 and those without,
NumPy and the C library likewise. What differs is the last digit. It guards against counts, active sets and pictures that hang on it, and
against tests that ask for more digits than there are. Environment variables choose, so that one build serves.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

import harmos_runs as runs  # noqa: E402

# What these tests look at does not depend on sums: sources, what is installed, what programs measure.
LABELS = "^(long|style|install|quickstart|performance)$"
# OpenBLAS' names, and what a processor must have for its kernels.
CORES = {
    "Prescott": {"pni"},
    "Nehalem": {"sse4_2"},
    "Haswell": {"avx2", "fma"},
    "Zen": {"avx2", "fma"},
    "SkylakeX": {"avx512f", "avx512dq", "avx512bw", "avx512vl"},
}
NARROW = {"HARMOS_WIDE_REGISTERS": "0"}


def processor():
    """What this processor has, in Linux' words."""
    for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("flags"):
            return set(line.split(":", 1)[1].split())
    return set()


def plain_numpy():
    """What NumPy is to leave alone of all that it has kernels for and this processor can do."""
    code = (
        "from numpy.core._multiarray_umath import __cpu_dispatch__ as known, __cpu_features__ as has\n"
        "print(*[name for name in known if has.get(name)])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    words = done.stdout.strip()
    return {"NPY_DISABLE_CPU_FEATURES": words} if done.returncode == 0 and words else {}


def kernels():
    """Environment variables by name."""
    has = processor()
    result = {core: {"OPENBLAS_CORETYPE": core} for core, needs in CORES.items() if needs <= has}
    result["narrow"] = NARROW
    # A processor of 2004: nothing takes wide registers or fused multiplication.
    result["plain"] = {
        **NARROW, **plain_numpy(), "OPENBLAS_CORETYPE": "Prescott",
        "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX,-AVX2,-FMA,-AVX512F",
    }
    return result


def core_in_use(variables):
    """What OpenBLAS says that it takes; None if the BLAS is another."""
    done = subprocess.run(
        [runs.application("harmos"), "--version"], capture_output=True, text=True, check=True,
        env={**os.environ, **variables, "OPENBLAS_VERBOSE": "2"},
    )
    lines = (done.stdout + done.stderr).splitlines()
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("Core:")), None)


def failures(variables, words):
    """The names of tests that fail, and whether any was run."""
    # A folder of its own: ctest within ctest would write over what that one notes.
    with tempfile.TemporaryDirectory(prefix="harmos_sums_") as place:
        Path(place, "CTestTestfile.cmake").write_text(f'subdirs("{runs.BINARY}")\n', encoding="utf-8")
        command = ["ctest", "--test-dir", place, "-LE", LABELS, "--output-on-failure", *words]
        done = subprocess.run(command, env={**os.environ, **variables}, check=False)
        failed = Path(place, "Testing", "Temporary", "LastTestsFailed.log")
        if done.returncode != 0 and not failed.exists():
            sys.exit("ctest has run no tests")
        names = failed.read_text(encoding="utf-8").splitlines() if failed.exists() else []
        return [line.split(":", 1)[1] for line in names]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--list", action="store_true", help="print the kernels and stop")
    parser.add_argument("--only", action="append", metavar="NAME", help="these kernels alone")
    arguments, words = parser.parse_known_args()
    chosen = kernels()
    for name in arguments.only or []:
        if name not in chosen:
            parser.error(f"{name}: no such kernels here, there are {', '.join(chosen)}")
    chosen = {name: chosen[name] for name in arguments.only or chosen}
    if arguments.list:
        for name, variables in chosen.items():
            print(f"{name}:", *(f"{key}={value}" for key, value in variables.items()), sep="  ")
        return 0
    if core_in_use({}) is None:
        runs.skip("the BLAS is not OpenBLAS with kernels for several processors")
    wrong = {}
    for name, variables in chosen.items():
        core = variables.get("OPENBLAS_CORETYPE")
        if core is not None and core_in_use(variables) != core:
            sys.exit(f"{core}: OpenBLAS takes the kernels for {core_in_use(variables)} in their place")
        print(f"=== {name}", flush=True)
        if failed := failures(variables, words):
            wrong[name] = failed
    for name, failed in wrong.items():
        print(f"with the kernels {name} fail: {', '.join(failed)}")
    print(f"{len(chosen)} kinds of kernels: {len(wrong)} with failures")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
