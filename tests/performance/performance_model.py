# SPDX-License-Identifier: BSD-3-Clause
"""Time of an iteration on P ranks, from latency, bandwidth and the size of the coarse problem.

    performance_model.py [--subdomains-per-rank 16] [--elements 128] [--shared] [--distributed] [--latency 2e-6]
                         [--bandwidth 1e10] [--output FILE]

One step of projected conjugate gradients with a Dirichlet preconditioner on the two-membrane
problem (scalar, square subdomains of N x N elements, s of them on a rank), weak scaling:

    products   two dense products a subdomain with its 4N boundary dofs: 2 * 2 (4N)^2 operations
               at the rate of matrix products where subdomains share a matrix; without sharing
               2 * 4 (4N)^2 bytes (packed, double) at the rate of reading memory
    vectors    the 4N/2 * s dual rows of a rank, `passes` times, at the rate of reading
    exchange   four neighbour exchanges (in and out of F and of the preconditioner): the latency
               of up to eight neighbours, and 8 bytes for each row on the rim of the rank's share
    scalars    two reductions of a few numbers: log2(P) latencies up, and as many down
    coarse     four reductions of n_c = s P numbers: as above, and twice the vector by the
               bandwidth; seven solves with L (three projections, one residual), replicated on each
               rank: dense, n_c^2/2 entries, up to 200, else 5 n_c log2(n_c) entries, as coarse_factor
               counts them (3.8 to 5.1 for grids of 32^2 to 256^2 subdomains). Distributed: four
               all-gathers of n_c numbers, products with the rank's s rows of the inverse of n_c
               numbers each, at the rate of reading, and four latencies for two exchanges with neighbours

The counts of reductions are those of tests/unit/feti/test_communication.cpp. Rates of products and of
reading are those that dual_operator shows on one rank of two, solves those of coarse_factor; the overhead is fitted to scaling.py. Latency and bandwidth of a network are to be
given; the defaults are assumptions about a common cluster and not measured.
"""

import argparse
import json
import math
import sys
from dataclasses import asdict, dataclass


@dataclass
class Machine:
    """Rates of one rank, in SI units."""

    gemm: float = 4.0e10  # operations a second
    read: float = 1.9e10  # bytes a second
    solve: float = 1.1e9  # entries of L a second, while L is in cache
    solve_from_memory: float = 2.5e8  # the same, when it is not
    latency: float = 2.0e-6  # seconds
    bandwidth: float = 1.0e10  # bytes a second
    overhead: float = 1.0e-4  # seconds of a step that depend on nothing


@dataclass
class Problem:
    subdomains_per_rank: int = 16
    elements: int = 128
    shared: bool = True
    passes: int = 40
    distributed: bool = False


def step(ranks, machine, problem):
    """The parts of a step's time on so many ranks, in seconds."""
    s, boundary = problem.subdomains_per_rank, 4 * problem.elements
    if problem.shared:
        products = s * 2 * 2 * boundary**2 / machine.gemm
    else:
        products = s * 2 * 4 * boundary**2 / machine.read
    rows = s * boundary / 2
    vectors = problem.passes * 8 * rows / machine.read
    rim = math.sqrt(s) * boundary
    neighbours = min(8, ranks - 1)
    exchange = 4 * (neighbours * machine.latency + (8 * rim / machine.bandwidth if ranks > 1 else 0))
    tree = 2 * math.log2(ranks) * machine.latency
    coarse_size = s * ranks
    if coarse_size <= 200:
        entries = 0.5 * coarse_size**2
    else:
        entries = 5 * coarse_size * math.log2(coarse_size)
    solve = machine.solve if entries < 5e5 else machine.solve_from_memory
    transfer = 2 * 8 * coarse_size / machine.bandwidth if ranks > 1 else 0
    coarse = 4 * (tree + transfer) + 7 * entries / solve
    if problem.distributed:
        rows_bytes = 8 * s * coarse_size
        neighbourly = 4 * machine.latency if ranks > 1 else 0
        coarse = 4 * (tree / 2 + transfer / 2 + rows_bytes / machine.read + neighbourly)
    return {
        "products": products,
        "vectors": vectors + machine.overhead,
        "exchange": exchange,
        "scalars": 2 * tree,
        "coarse": coarse,
    }


def takeover(machine, problem, most=10**6):
    """The number of ranks from which on the coarse problem costs more than all else."""
    ranks = 1
    while ranks <= most:
        parts = step(ranks, machine, problem)
        if parts["coarse"] > sum(parts.values()) - parts["coarse"]:
            return ranks
        ranks = max(ranks + 1, round(1.05 * ranks))
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--subdomains-per-rank", type=int, default=16)
    parser.add_argument("--elements", type=int, default=128)
    parser.add_argument("--shared", action="store_true")
    parser.add_argument("--distributed", action="store_true")
    for name in ("gemm", "read", "solve", "solve_from_memory", "latency", "bandwidth", "overhead"):
        parser.add_argument(f"--{name.replace('_', '-')}", type=float, default=getattr(Machine, name))
    parser.add_argument("--output")
    given = parser.parse_args()
    machine = Machine(*(getattr(given, name) for name in asdict(Machine())))
    problem = Problem(
        given.subdomains_per_rank, given.elements, given.shared, distributed=given.distributed
    )
    table = []
    print(f"{'ranks':>8} {'products':>10} {'vectors':>10} {'exchange':>10} {'scalars':>10} {'coarse':>10}")
    for ranks in (1, 2, 10, 100, 1000, 10000, 100000):
        parts = step(ranks, machine, problem)
        table.append({"ranks": ranks, **parts})
        print(f"{ranks:8}" + "".join(f" {value:10.2e}" for value in parts.values()))
    where = takeover(machine, problem)
    print(f"The coarse problem takes over at {where} ranks.")
    if given.output:
        document = {
            "benchmark": "performance_model",
            "machine": asdict(machine),
            "problem": asdict(problem),
            "steps": table,
            "coarse_takes_over_at": where,
        }
        with open(given.output, "w", encoding="utf-8") as file:
            json.dump(document, file, indent=2)
    return 0


if __name__ == "__main__":
    sys.exit(main())
