# SPDX-License-Identifier: BSD-3-Clause
"""Time, messages and memory of a step on P ranks, from latency, bandwidth and the size of the coarse problem.

    performance_model.py [--physics membrane|solid] [--subdomains-per-rank 16] [--elements 128] [--shared]
                         [--form replicated|distributed|auto] [--cluster 1] [--latency 2e-6] [--bandwidth 1e10]
                         [--output FILE] [--cases FILE] [--tables]

One step of projected conjugate gradients with a Dirichlet preconditioner, weak scaling: s subdomains on a
rank, a compact share of a square of membranes (one unknown a node, one motion a subdomain; 16 of 128 x 128
elements if nothing else is given) or of a cube of solids (three, and six; 8 of 8 x 8 x 8).

    products   two dense products a subdomain with its b boundary dofs, b = 4 N or 3 (6 N^2 + 2): 2 * 2 b^2
               operations at the rate of matrix products where subdomains share a matrix; without
               sharing 2 * 4 b^2 bytes (packed, double) at the rate of reading memory
    vectors    the dual rows of a rank, `PASSES` times, at the rate of reading
    exchange   neighbour exchanges, in and out of F and of the preconditioner: the latency of up to 8 or 26
               neighbours, and 8 bytes for each row on the rim of the rank's share
    scalars    reductions of a few numbers by themselves: log2(P) latencies up, and as many down; those
               that travel with the coarse problem cost nothing
    coarse     replicated: reductions of n_c numbers, as above, and twice the vector by the bandwidth; solves
               with L on every rank. Distributed: all-gathers of n_c numbers and scalars, products with the rank's rows
               of the inverse, n_c numbers each, at the rate of reading, and exchanges of motions with
               neighbours; where the rows would take more than 512 MiB, solves by groups of ranks
    joins      with clusters of so many subdomains (--cluster), which have the motions of one: what joins them,
               W = [K^+ B_0', R] of each operator, is read twice for F and, without R, twice for the
               preconditioner, at the rate of reading, F_0 solved with three times. Products grow, see GROWTH

How many of each there are stands in CALLS, once. Formulas and rates are those of C++:
Harmos_StepModel.hpp, Harmos_ClusterModel.hpp, Harmos_CoarseModel.hpp, Harmos_StepCalls.hpp in
packages/feti/src, by which `Coarse problem` and `Clusters` = `auto` decide and --plan predicts. `--cases` writes shapes and what they give here, with
which tests/unit/feti/test_step_model.cpp compares, `--tables` those of the pages (messages/performance_tables.py). Rates of products and of reading are those that
dual_operator shows on one rank of two, solves those of coarse_factor; the overhead is fitted to scaling.py.
Latency and bandwidth of a network are to be given; the defaults are assumptions about a common cluster and
not measured.
"""

import argparse
import json
import math
import sys
from dataclasses import asdict, dataclass, replace
from pathlib import Path

FORMS = ("replicated", "distributed")
RANKS = (1, 2, 10, 100, 1000, 10000, 100000)
WORD = 8
PASSES = 40
MOST_DENSE = 200  # rows of a coarse matrix that is factored densely
# Products grow by 1 + a_d (m^(1/d) - 1) + c_d (aspect - 1) with clusters of m subdomains: a_d and c_d.
GROWTH = {2: 0.42, 3: 0.71}
SLENDER = {2: 0.4, 3: 1.2}
AT_ONCE = 6  # vectors that take as long to multiply with W as it takes to read it


@dataclass(frozen=True)
class Calls:
    """Of a step, as Harmos_StepCalls.hpp has them."""

    exchanges: float  # of dual rows with neighbours
    coarse_vectors: float  # collectives of a number for each motion
    coarse_exchanges: float  # of numbers of motions with neighbours
    coarse_solves: float  # with L or its transpose; products with own rows of the inverse
    reductions: float  # of a few numbers
    reduced_numbers: float  # in all collectives; in an all-gather those of each rank come


CALLS = {"replicated": Calls(4, 2, 0, 4, 0, 6), "distributed": Calls(4, 2, 4, 2, 0, 6)}


@dataclass
class Machine:
    """Rates of one rank, in SI units; those of C++'s StepRates, and `gemm`."""

    gemm: float = 4.0e10  # operations a second
    read: float = 1.9e10  # bytes a second
    solve: float = 1.1e9  # entries of L a second, while L is in cache
    solve_from_memory: float = 2.5e8  # the same, when it is not
    latency: float = 2.0e-6  # seconds
    bandwidth: float = 1.0e10  # bytes a second
    overhead: float = 1.0e-4  # seconds of a step that depend on nothing


@dataclass
class Shape:
    """What a step depends on: C++'s StepShape, on the busiest rank."""

    ranks: int = 1
    rows: float = 0.0  # of dual vectors
    shared_rows: float = 0.0  # that other ranks touch too, once for each of these
    neighbours: int = 0
    coarse_dimension: float = 0.0
    coarse_entries: float = 0.0  # of L; 0: factor_entries()
    own_motions: float = 0.0  # of its subdomains
    motions: float = 1.0  # of a subdomain
    shared_motions: float = 0.0  # of others' that its rows touch, and the other way round
    # Where subdomains are joined, motions are those of clusters.
    cluster_size: float = 1.0  # subdomains of a cluster
    join_bytes: float = 0.0  # read to join them, in a product with F and one with the preconditioner
    join_entries: float = 0.0  # of L of F_0, in the solves of these


@dataclass
class Clusters:
    """What clusters of a rank cost depends on: C++'s ClusterShape."""

    size: float = 1.0  # m, subdomains of a cluster
    share: float = 1.0  # clusters for each subdomain, over all ranks
    subdomains: float = 1.0  # of the rank
    distinct: float = 1.0  # operators that they have
    boundary: float = 0.0  # dofs of a subdomain's
    motions: float = 1.0  # of a subdomain that floats
    aspect: float = 1.0  # of a cluster's sides

    @property
    def dimension(self):
        return 3 if self.motions > 3.5 else 2


@dataclass
class Problem:
    subdomains_per_rank: int = 16
    elements: int = 128
    shared: bool = True
    physics: str = "membrane"
    form: str = "replicated"
    cluster: int = 1  # subdomains of a cluster

    @property
    def dimension(self):
        return 3 if self.physics == "solid" else 2

    @property
    def motions(self):
        return 6 if self.physics == "solid" else 1

    def boundary(self):
        """Dofs on a subdomain's boundary."""
        n = self.elements
        return 3 * (6 * n * n + 2) if self.physics == "solid" else 4 * n

    def rows(self):
        """Dual rows of a subdomain, each once: a node of k copies has k - 1."""
        n = self.elements
        if self.physics == "solid":
            return 3 * (3 * (n - 1) ** 2 + 3 * 3 * (n - 1) + 7)
        return 2 * (n - 1) + 3

    def touched_rows(self):
        """Rows with entries in a subdomain, in the mean: row k acts on the first k + 1 copies."""
        n = self.elements
        if self.physics == "solid":
            return 3 * (6 * (n - 1) ** 2 + 12 * (n - 1) * 9 / 4 + 8 * 35 / 8)
        return 4 * (n - 1) + 4 * 9 / 4


def is_in_space(shape):
    return shape.motions > 3.5


def factor_entries(shape):
    """Entries of L; see CoarseModel."""
    if shape.coarse_entries > 0:
        return shape.coarse_entries
    n, m = shape.coarse_dimension, max(1, shape.motions)
    if n <= MOST_DENSE:
        return 0.5 * n * (n + 1)
    subdomains = max(2, n / m)
    if is_in_space(shape):
        x = subdomains ** (1 / 3)
        return m * m * subdomains * (0.8 * x * x if x < 6 else 9.6 * (x - 3))
    levels = math.log2(subdomains)
    joined = 4.3 if m < 1.5 else 0.0  # zeros in fronts of few columns that are one
    return m * m * subdomains * max(3.6 * levels - 15.5 + joined, 1.35 * levels)


def group_of(shape):
    """Ranks that factor a distributed coarse problem together."""
    ranks = math.ceil(16 * factor_entries(shape) / (128 * 2**20))
    return min(max(ranks, min(2, shape.ranks)), shape.ranks)


def is_solved(shape):
    """Whether groups solve, since rows of the inverse take too much memory."""
    return WORD * shape.coarse_dimension * shape.own_motions > 512 * 2**20


def growth_of_products(size, dimension, aspect=1):
    side = max(1, size) ** (1 / dimension)
    return 1 + GROWTH[dimension] * math.log2(side) + SLENDER[dimension] * (max(1, aspect) - 1)


def join_costs(clusters):
    """See ClusterModel."""
    m, r, d = clusters.size, clusters.motions, clusters.dimension
    if m <= 1:
        return {"averages": 0.0, "bytes_read": 0.0, "entries": 0.0, "bytes_held": 0.0}
    faces, number = d * (m - m ** ((d - 1) / d)), clusters.subdomains / m
    is_shared = clusters.distinct < clusters.subdomains
    joined = r * (min(2 * d, 2 * faces) if is_shared else 2 * faces / m)
    w = WORD * clusters.boundary * (2 * joined + r) * clusters.distinct
    readings = max(1, clusters.subdomains / (AT_ONCE * clusters.distinct))
    of_motions = WORD / 2 * r * m * (r * m + 1)
    entries = factor_entries(Shape(coarse_dimension=r * faces, motions=r))
    return {
        "averages": r * faces,
        "bytes_read": 2 * w * readings + number * of_motions,
        "entries": 6 * number * entries,
        "bytes_held": w + number * (32 * entries + of_motions),
    }


def with_clusters(shape, clusters):
    """A step with clusters, of one without."""
    if clusters.size <= 1:
        return shape
    d, number = clusters.dimension, clusters.subdomains / clusters.size
    costs = join_costs(clusters)
    return replace(
        shape,
        coarse_dimension=shape.coarse_dimension * clusters.share,
        coarse_entries=0.0,
        own_motions=shape.own_motions / clusters.size,
        shared_motions=shape.motions * ((number ** (1 / d) + 2) ** d - number) if shape.ranks > 1 else 0.0,
        cluster_size=clusters.size,
        join_bytes=costs["bytes_read"],
        join_entries=costs["entries"],
    )


def coarse_seconds(shape, machine, form):
    calls, n = CALLS[form], shape.coarse_dimension
    tree = math.log2(shape.ranks) * machine.latency
    transfer = WORD * n / machine.bandwidth if shape.ranks > 1 else 0
    entries = factor_entries(shape)
    if form == "replicated":
        rate = machine.solve if entries < 5e5 else machine.solve_from_memory
        return calls.coarse_vectors * 2 * (tree + transfer) + calls.coarse_solves * entries / rate
    if is_solved(shape):
        solve = 2 * entries / (machine.solve_from_memory * math.sqrt(group_of(shape)))
    else:
        solve = WORD * n * shape.own_motions / machine.read
    neighbourly = calls.coarse_exchanges * shape.neighbours * machine.latency if shape.ranks > 1 else 0
    gathered = calls.coarse_vectors * n + calls.reduced_numbers * shape.ranks
    transfer = WORD * gathered / machine.bandwidth if shape.ranks > 1 else 0
    return calls.coarse_vectors * tree + transfer + calls.coarse_solves * solve + neighbourly


def is_distributed_cheaper(shape, machine):
    """What `auto` decides."""
    replicated, distributed = (coarse_seconds(shape, machine, form) for form in FORMS)
    return shape.ranks >= 8 and distributed < 0.5 * replicated


def step_seconds(shape, machine, form):
    """All but the products."""
    calls, several = CALLS[form], shape.ranks > 1
    of_neighbours = shape.neighbours * machine.latency + WORD * shape.shared_rows / machine.bandwidth
    return {
        "vectors": PASSES * WORD * shape.rows / machine.read + machine.overhead,
        "exchange": calls.exchanges * of_neighbours if several else 0.0,
        "scalars": calls.reductions * 2 * math.log2(shape.ranks) * machine.latency,
        "coarse": coarse_seconds(shape, machine, form),
        "joins": shape.join_bytes / machine.read + shape.join_entries / machine.solve,
    }


def counts(shape, form):
    """What a step says to other ranks: messages sent to neighbours; collectives, and what comes by them."""
    calls, alone = CALLS[form], shape.ranks == 1
    is_distributed = form == "distributed"
    exchanged = calls.exchanges * shape.shared_rows + calls.coarse_exchanges * shape.shared_motions
    sums = calls.reduced_numbers * (shape.ranks if is_distributed else 1)
    numbers = calls.coarse_vectors * shape.coarse_dimension + sums
    table = {
        "messages": (calls.exchanges + calls.coarse_exchanges) / 2 * shape.neighbours,
        "message_bytes": WORD * exchanged / 2,
        "reductions": calls.reductions + (0 if is_distributed else calls.coarse_vectors),
        "gathers": calls.coarse_vectors if is_distributed else 0,
        "collective_bytes": WORD * numbers,
    }
    return {name: 0 if alone else value for name, value in table.items()}


def coarse_bytes(shape, form):
    """Of a rank: L with row numbers, its own rows of the inverse, or its part of a group's factor."""
    if form == "replicated":
        return 16 * factor_entries(shape)
    if is_solved(shape):
        return 16 * factor_entries(shape) / group_of(shape)
    return WORD * shape.coarse_dimension * shape.own_motions


def clusters_of(problem):
    s, m = problem.subdomains_per_rank, problem.cluster
    return Clusters(m, 1 / m, s, 1 if problem.shared else s, problem.boundary(), problem.motions)


def shape_of(problem, ranks):
    """Of a rank in the middle of so many, with a share that is about a square or a cube."""
    d, s, m = problem.dimension, problem.subdomains_per_rank, problem.motions
    side = s ** (1 / d)
    shape = Shape(
        ranks=ranks,
        rows=s * problem.rows(),
        shared_rows=problem.touched_rows() * side ** (d - 1) if ranks > 1 else 0,
        neighbours=min(3**d, ranks) - 1,
        coarse_dimension=m * s * ranks,
        own_motions=m * s,
        motions=m,
        shared_motions=m * ((side + 2) ** d - s) if ranks > 1 else 0,
    )
    return with_clusters(shape, clusters_of(problem))


def form_of(problem, shape, machine):
    if problem.form != "auto":
        return problem.form
    return FORMS[is_distributed_cheaper(shape, machine)]


def step(ranks, machine, problem):
    """The parts of a step's time on so many ranks, in seconds."""
    size = problem.subdomains_per_rank * problem.boundary() ** 2
    products = 2 * 2 * size / machine.gemm if problem.shared else 2 * 4 * size / machine.read
    shape = shape_of(problem, ranks)
    return {"products": products, **step_seconds(shape, machine, form_of(problem, shape, machine))}


def takeover(machine, problem, most=10**6):
    """The number of ranks from which on the coarse problem costs more than all else."""
    ranks = 1
    while ranks <= most:
        parts = step(ranks, machine, problem)
        if parts["coarse"] > sum(parts.values()) - parts["coarse"]:
            return ranks
        ranks = max(ranks + 1, round(1.05 * ranks))
    return None


def distributed_from(machine, problem, most=10**6):
    """The number of ranks from which on `auto` distributes the coarse problem."""
    for ranks in range(1, most):
        if is_distributed_cheaper(shape_of(problem, ranks), machine):
            return ranks
    return None


def table_of(machine, problem):
    """A row for each of RANKS."""
    rows = []
    for ranks in RANKS:
        shape = shape_of(problem, ranks)
        form = form_of(problem, shape, machine)
        rows.append(
            {
                "ranks": ranks,
                "form": form,
                "coarse_dimension": shape.coarse_dimension,
                **step(ranks, machine, problem),
                **counts(shape, form),
                "coarse_mib": coarse_bytes(shape, form) / 2**20,
            }
        )
    return rows


def cases():
    """Shapes of both physics, and what they give in both forms by the rates that stand here."""
    machine, result = Machine(), []
    loads = (("membrane", 16, 128), ("membrane", 1, 16), ("solid", 8, 8), ("solid", 27, 4))
    problems = [Problem(subdomains, elements, physics=physics) for physics, subdomains, elements in loads]
    # Pieces of ranks and whole ones, alike and no two alike.
    problems += [Problem(16, 128, shared, cluster=m) for shared in (True, False) for m in (4, 16)]
    problems += [Problem(8, 8, shared, "solid", cluster=m) for shared in (True, False) for m in (2, 8)]
    problems += [Problem(125, 4, False, "solid", cluster=125)]
    for problem in problems:
        for ranks in (*RANKS, 8, 64):
            shape, clusters = shape_of(problem, ranks), clusters_of(problem)
            item = {"shape": asdict(shape), "distributed_by_auto": is_distributed_cheaper(shape, machine)}
            if problem.cluster > 1:
                item["alone"] = asdict(shape_of(replace(problem, cluster=1), ranks))
                clusters = replace(clusters, aspect=1.0 if problem.shared else 4.0)
                item["clusters"] = asdict(clusters) | join_costs(clusters)
                item["growth"] = growth_of_products(clusters.size, clusters.dimension, clusters.aspect)
            for form in FORMS:
                item[form] = {
                    **step_seconds(shape, machine, form),
                    **counts(shape, form),
                    "coarse_bytes": coarse_bytes(shape, form),
                }
            result.append(item)
    return {"calls": {form: asdict(calls) for form, calls in CALLS.items()}, "cases": result}


def as_json(document):
    return json.dumps(document, indent=1) + "\n"


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--physics", choices=("membrane", "solid"), default="membrane")
    parser.add_argument("--subdomains-per-rank", type=int, help="16 of membranes, 8 of solids")
    parser.add_argument("--elements", type=int, help="a side of a subdomain; 128 of membranes, 8 of solids")
    parser.add_argument("--shared", action="store_true")
    parser.add_argument("--cluster", type=int, default=1, help="subdomains of a cluster; 1: none")
    parser.add_argument("--form", choices=(*FORMS, "auto"), default="replicated")
    for name in asdict(Machine()):
        parser.add_argument(f"--{name.replace('_', '-')}", type=float, default=getattr(Machine, name))
    parser.add_argument("--cases", metavar="FILE", help="shapes and what they give, for the test of C++")
    parser.add_argument("--tables", action="store_true", help="those of docs/dual_operator.md and docs/clusters.md")
    parser.add_argument("--output", metavar="FILE")
    return parser.parse_args()


SECONDS = ("products", "vectors", "exchange", "scalars", "coarse", "joins")


def main():
    given = arguments()
    if given.cases:
        with open(given.cases, "w", encoding="utf-8") as file:
            file.write(as_json(cases()))
        return 0
    if given.tables:
        sys.path.append(str(Path(__file__).resolve().parent / "messages"))
        import performance_tables  # which imports this

        print(performance_tables.all_of_them())
        return 0
    machine = Machine(*(getattr(given, name) for name in asdict(Machine())))
    subdomains, elements = (8, 8) if given.physics == "solid" else (16, 128)
    problem = Problem(
        given.subdomains_per_rank or subdomains,
        given.elements or elements,
        given.shared,
        given.physics,
        given.form,
        given.cluster,
    )
    table = table_of(machine, problem)
    print(f"{'ranks':>8} {'coarse':>12}" + "".join(f"{name:>10}" for name in SECONDS), end="")
    print("  messages     bytes  reductions  gathers     bytes  coarse MiB")
    for row in table:
        print(
            f"{row['ranks']:8} {row['form']:>12}"
            + "".join(f"{row[name]:10.2e}" for name in SECONDS)
            + f"{row['messages']:10.0f}{row['message_bytes']:10.2g}{row['reductions']:12.0f}"
            f"{row['gathers']:9.0f}{row['collective_bytes']:10.2g}{row['coarse_mib']:12.3g}"
        )
    where = takeover(machine, problem)
    apart = distributed_from(machine, problem)
    print(f"The coarse problem takes over at {where} ranks; `auto` distributes it from {apart} ranks on.")
    if given.output:
        document = {
            "benchmark": "performance_model",
            "machine": asdict(machine),
            "problem": asdict(problem),
            "steps": table,
            "coarse_takes_over_at": where,
            "distributed_from": apart,
        }
        with open(given.output, "w", encoding="utf-8") as file:
            json.dump(document, file, indent=2)
    return 0


if __name__ == "__main__":
    sys.exit(main())
