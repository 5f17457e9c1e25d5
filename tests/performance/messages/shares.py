# SPDX-License-Identifier: BSD-3-Clause
"""What ranks share of a block that is cut into a grid of subdomains, row by row.

The rule for a dof with k copies (Harmos_GluingRows.hpp, Harmos_Constraints.cpp): it has k - 1 rows, of
which row j acts on the first j + 2 copies in the order of subdomains, and belongs to the rank of the first.
Where prescribed values are rows too (Total FETI), a dof that is held has one for each copy in their place.
Subdomains are numbered along x, then y, then z, and each rank has consecutive ones (scene::shareOf()): of
an oblong share more is at its rim than performance_model.py takes for a compact one. Where they may be joined
to clusters they are numbered so that shares are compact (Harmos_CompactOrder.cpp).
"""

import itertools
import math
import sys
from collections import Counter, defaultdict
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import performance_model


def nodes_along(subdomains, elements):
    """Of a direction: how many nodes lie in which subdomains, and whether they are the first."""
    count = Counter()
    for node in range(subdomains * elements + 1):
        place = node // elements
        meets = node % elements == 0 and 0 < place < subdomains
        count[(place - 1, place) if meets else (min(place, subdomains - 1),), node == 0] += 1
    return count


def pieces_of(groups):
    for prime in (2, 3, 5, 7):
        if groups % prime == 0 and (prime <= 3 or groups // prime >= prime):
            return prime
    return 2


def compact_numbers(grid, ranks):
    """The number of each subdomain, a square or a cube, by that along x, then y, then z."""
    total = math.prod(grid)
    strides = [math.prod(grid[:d]) for d in range(len(grid))]
    before = [total * r // ranks for r in range(ranks + 1)]
    place = [
        tuple(number // stride % side for stride, side in zip(strides, grid)) for number in range(total)
    ]
    order = []

    def cut(items, first, end):
        if end - first <= 1 or not items:
            order.extend(sorted(items))
            return
        extent = [max(place[i][d] for i in items) - min(place[i][d] for i in items) for d in range(len(grid))]
        axes = sorted(range(len(grid)), key=lambda d: -extent[d])
        items = sorted(items, key=lambda i: ([place[i][d] for d in axes], i))
        pieces = pieces_of(end - first)
        for k in range(pieces):
            one, two = first + (end - first) * k // pieces, first + (end - first) * (k + 1) // pieces
            cut(items[before[one] - before[first] : before[two] - before[first]], one, two)

    cut(list(range(total)), 0, ranks)
    numbers = [0] * total
    for number, item in enumerate(order):
        numbers[item] = number
    return numbers


def copies(grid, elements, number_of):
    """Subdomains, rising, that have a node in common, how many such nodes there are, and whether these are held:
    at the beginning of the first or the last direction."""
    strides = [math.prod(grid[:d]) for d in range(len(grid))]
    for parts in itertools.product(*(nodes_along(side, elements).items() for side in grid)):
        places = itertools.product(*(place for (place, _), _ in parts))
        numbers = sorted(
            number_of[sum(at * stride for at, stride in zip(place, strides))] for place in places
        )
        (_, is_left), (_, is_bottom) = parts[0][0], parts[-1][0]
        yield numbers, math.prod(nodes for _, nodes in parts), is_left or is_bottom


def shapes(grid, elements, ranks, clusters="none"):
    """Each rank's performance_model.Shape; a grid of two sides is a membrane. Where the first and the last
    direction begin subdomains are held, if they are by themselves. With `clusters` = rank those of a rank are
    one, and what is prescribed are rows."""
    is_joined = clusters == "rank"
    total = math.prod(grid)
    components, motions = (1, 1) if len(grid) == 2 else (3, 6)
    rank_of = [r for r in range(ranks) for _ in range(total * r // ranks, total * (r + 1) // ranks)]
    layer = total // grid[-1]
    moves = [is_joined or (number % grid[0] > 0 and number >= layer) for number in range(total)]
    rows, shared = [0] * ranks, [0] * ranks
    near = defaultdict(set)  # ranks with which a rank exchanges rows
    columns = set()  # subdomains, or clusters by their rank, that the rows of a rank touch
    number_of = compact_numbers(grid, ranks) if is_joined else list(range(total))
    for numbers, nodes, is_held in copies(grid, elements, number_of):
        owner, count = rank_of[numbers[0]], components * nodes
        if is_held and is_joined:
            for number in numbers:
                rows[rank_of[number]] += count
            continue
        for row in range(len(numbers) - 1):
            touched = numbers[: row + 2]
            rows[owner] += count
            columns.update((owner, rank_of[number] if is_joined else number) for number in touched)
            for other in {rank_of[number] for number in touched} - {owner}:
                for one, two in ((owner, other), (other, owner)):
                    shared[one] += count
                    near[one].add(two)
    foreign, own = [0] * ranks, [0] * ranks
    for rank, number in columns:
        other = number if is_joined else rank_of[number]
        if moves[number] and other != rank:
            foreign[rank] += motions
            foreign[other] += motions
    for number, rank in enumerate(rank_of):
        own[rank] += motions * moves[number]
    if is_joined:
        own = [motions] * ranks
    return [
        performance_model.Shape(
            ranks=ranks,
            rows=rows[rank],
            shared_rows=shared[rank],
            neighbours=len(near[rank]),
            coarse_dimension=sum(own),
            own_motions=own[rank],
            motions=motions if is_joined else sum(own) / total,
            shared_motions=foreign[rank],
        )
        for rank in range(ranks)
    ]
