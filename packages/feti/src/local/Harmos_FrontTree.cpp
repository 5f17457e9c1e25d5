// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_FrontTree.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Index.hpp"

#include <algorithm>
#include <metis.h>
#include <numeric>

namespace Harmos::feti {
namespace {

// Neighbouring rows with the same columns, as the components of a displacement at a node are, are one vertex:
// all that follows is done once for them.
struct Quotient {
  std::vector<std::size_t> offsets = {0};
  std::vector<int> columns;
  std::vector<int> first, weight; ///< row of a vertex, and how many
  int remaining = 0;              ///< vertices that stay: the last ones

  int size() const { return static_cast<int>(first.size()); }
};

Quotient quotientOf(const LocalMatrix& pattern, const std::vector<int>& rest, FrontTree::Rest use) {
  const int n = pattern.rows();
  std::vector<char> stays(at(n), 0);
  for (int row : rest)
    stays[at(row)] = use == FrontTree::Rest::Stays ? 1 : 2;
  const auto begin = [&](int row) {
    return pattern.columns.begin() + static_cast<std::ptrdiff_t>(pattern.offsets[at(row)]);
  };
  Quotient q;
  std::vector<int> vertex(at(n), -1);
  for (char phase = 0; phase < 2; ++phase)
    for (int row = 0; row < n; ++row) {
      if (stays[at(row)] != phase)
        continue;
      const bool joins = row > 0 && stays[at(row - 1)] == phase && !q.first.empty() &&
                         std::equal(begin(row - 1), begin(row), begin(row), begin(row + 1));
      if (!joins) {
        q.first.push_back(row);
        q.weight.push_back(0);
        q.remaining += phase;
      }
      ++q.weight.back();
      vertex[at(row)] = q.size() - 1;
    }
  q.offsets.reserve(q.first.size() + 1);
  for (int row : q.first) {
    // Columns rise, and so do vertices but for the change from eliminated ones to those that stay.
    const std::size_t from = q.columns.size();
    for (auto c = begin(row); c != begin(row + 1); ++c)
      if (const int v = vertex[at(*c)]; v >= 0 && (q.columns.size() == from || q.columns.back() != v))
        q.columns.push_back(v);
    std::sort(q.columns.begin() + static_cast<std::ptrdiff_t>(from), q.columns.end());
    q.columns.erase(std::unique(q.columns.begin() + static_cast<std::ptrdiff_t>(from), q.columns.end()),
                    q.columns.end());
    q.offsets.push_back(q.columns.size());
  }
  return q;
}

// Vertices in METIS' order of nested dissection; those that stay behind them.
std::vector<int> nestedDissection(const Quotient& q) {
  const int m = q.size() - q.remaining;
  std::vector<idx_t> offsets = {0}, adjacent, weights(q.weight.begin(), q.weight.begin() + m);
  offsets.reserve(at(m) + 1);
  adjacent.reserve(q.columns.size());
  for (int v = 0; v < m; ++v) {
    for (std::size_t k = q.offsets[at(v)]; k < q.offsets[at(v) + 1]; ++k)
      if (const int w = q.columns[k]; w != v && w < m)
        adjacent.push_back(w);
    offsets.push_back(static_cast<idx_t>(adjacent.size()));
  }
  std::vector<int> order(at(q.size()));
  std::iota(order.begin(), order.end(), 0);
  if (!adjacent.empty()) {
    idx_t count = m;
    std::vector<idx_t> permutation(at(m)), inverse(at(m)), options(METIS_NOPTIONS);
    METIS_SetDefaultOptions(options.data());
    options[METIS_OPTION_COMPRESS] = 0;
    const int status = METIS_NodeND(&count, offsets.data(), adjacent.data(), weights.data(), options.data(),
                                    permutation.data(), inverse.data());
    HARMOS_REQUIRE(status == METIS_OK, "METIS could not order a subdomain's matrix");
    std::copy(permutation.begin(), permutation.end(), order.begin());
  }
  return order;
}

// Vertices in the order of a tree; those that stay, and few that it does not eliminate, behind them. Empty
// where those are not few: they would make a dense block.
std::vector<int> orderOf(const FrontTree& tree, const Quotient& q) {
  const int m = q.size() - q.remaining;
  std::vector<int> key, order(at(q.size()));
  int strangers = 0;
  for (int v = 0; v < q.size(); ++v) {
    const int place = tree.place[at(q.first[at(v)])];
    const bool isKnown = v < m && place >= 0 && place < tree.eliminated();
    strangers += v < m && !isKnown ? 1 : 0;
    key.push_back(isKnown ? place : tree.size() + v);
  }
  if (50 * strangers > m)
    return {};
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return key[at(a)] < key[at(b)]; });
  return order;
}

std::vector<int> inverseOf(const std::vector<int>& order, std::size_t size) {
  std::vector<int> place(size, -1);
  for (std::size_t k = 0; k < order.size(); ++k)
    place[at(order[k])] = static_cast<int>(k);
  return place;
}

// The elimination tree (Liu) of the first m places; m itself stands for all that stay, and for no parent.
std::vector<int> eliminationTree(const Quotient& q, const std::vector<int>& order,
                                 const std::vector<int>& place, int m) {
  std::vector<int> parent(at(m), m), ancestor(at(m), -1);
  for (int k = 0; k < q.size(); ++k) {
    const int root = std::min(k, m);
    const int v = order[at(k)];
    for (std::size_t e = q.offsets[at(v)]; e < q.offsets[at(v) + 1]; ++e)
      for (int j = place[at(q.columns[e])]; j < root;) {
        const int next = ancestor[at(j)];
        ancestor[at(j)] = root;
        if (next < 0) {
          parent[at(j)] = root;
          break;
        }
        j = next;
      }
  }
  return parent;
}

// Places of a tree so that each subtree stands together, children before parents.
std::vector<int> postorder(const std::vector<int>& parent) {
  const int m = static_cast<int>(parent.size());
  std::vector<int> head(at(m) + 1, -1), next(at(m), -1), result, stack;
  for (int j = m - 1; j >= 0; --j) {
    next[at(j)] = head[at(parent[at(j)])];
    head[at(parent[at(j)])] = j;
  }
  result.reserve(at(m));
  for (int root = head[at(m)]; root >= 0; root = next[at(root)]) {
    stack.push_back(root);
    while (!stack.empty()) {
      const int j = stack.back();
      if (const int child = head[at(j)]; child >= 0) {
        head[at(j)] = next[at(child)];
        stack.push_back(child);
      } else {
        result.push_back(j);
        stack.pop_back();
      }
    }
  }
  return result;
}

// Rows of each vertex' columns of L below it: each counts where its path up the tree leads.
std::vector<int> columnCounts(const Quotient& q, const std::vector<int>& order, const std::vector<int>& place,
                              const std::vector<int>& parent) {
  const int m = static_cast<int>(parent.size());
  std::vector<int> count(at(m), 0), mark(at(m), -1);
  for (int k = 0; k < q.size(); ++k) {
    const int v = order[at(k)];
    for (std::size_t e = q.offsets[at(v)]; e < q.offsets[at(v) + 1]; ++e)
      for (int j = place[at(q.columns[e])]; j < std::min(k, m) && mark[at(j)] != k; j = parent[at(j)]) {
        mark[at(j)] = k;
        count[at(j)] += q.weight[at(v)];
      }
  }
  return count;
}

// Whether a front and the one above, of so many columns, are better off as one, of whose stored entries these
// are zeros (the bounds of CHOLMOD; Chen, Davis, Hager, Rajamanickam, ACM Trans. Math. Softw. 35, 2008).
bool areToBeJoined(int columns, double zeros, double entries) {
  return columns <= 4 || (columns <= 16 && zeros < 0.8 * entries) ||
         (columns <= 48 && zeros < 0.1 * entries) || zeros < 0.05 * entries;
}

// A front in vertices, [first, end), of so many rows.
struct Piece {
  int first, end;
  int columns, below;
};

// Columns with the same rows below; each joined with the one after it, its parent, where that pays.
std::vector<Piece> pieces(const Quotient& q, const std::vector<int>& order, const std::vector<int>& parent,
                          const std::vector<int>& count) {
  std::vector<Piece> whole, kept;
  for (int j = 0; j < static_cast<int>(parent.size()); ++j) {
    const int weight = q.weight[at(order[at(j)])];
    if (j > 0 && parent[at(j - 1)] == j && count[at(j - 1)] == count[at(j)] + weight)
      whole.back() = {whole.back().first, j + 1, whole.back().columns + weight, count[at(j)]};
    else
      whole.push_back({j, j + 1, weight, count[at(j)]});
  }
  std::vector<double> zeros;
  for (Piece piece : whole) {
    double z = 0.0;
    for (; !kept.empty() && parent[at(kept.back().end - 1)] == piece.first;
         kept.pop_back(), zeros.pop_back()) {
      const Piece& child = kept.back();
      const int columns = child.columns + piece.columns;
      const double more =
          zeros.back() + z + static_cast<double>(child.columns) * (piece.columns + piece.below - child.below);
      const double entries = 0.5 * columns * (columns + 1.0) + static_cast<double>(columns) * piece.below;
      if (!areToBeJoined(columns, more, entries))
        break;
      piece.first = child.first;
      piece.columns = columns;
      z = more;
    }
    kept.push_back(piece);
    zeros.push_back(z);
  }
  return kept;
}

// Vertices below each piece, rising: those of the matrix, and what the children leave.
std::vector<std::vector<int>> verticesBelow(const Quotient& q, const std::vector<int>& order,
                                            const std::vector<int>& place, const std::vector<Piece>& all) {
  const int m = q.size() - q.remaining;
  std::vector<int> pieceOf(at(m)), mark(at(q.size()), -1);
  for (std::size_t p = 0; p < all.size(); ++p)
    std::fill(pieceOf.begin() + all[p].first, pieceOf.begin() + all[p].end, static_cast<int>(p));
  std::vector<std::vector<int>> children(all.size()), below(all.size());
  for (std::size_t p = 0; p < all.size(); ++p) {
    const auto add = [&](int v) {
      if (v >= all[p].end && mark[at(v)] != static_cast<int>(p)) {
        mark[at(v)] = static_cast<int>(p);
        below[p].push_back(v);
      }
    };
    for (int j = all[p].first; j < all[p].end; ++j) {
      const int v = order[at(j)];
      for (std::size_t e = q.offsets[at(v)]; e < q.offsets[at(v) + 1]; ++e)
        add(place[at(q.columns[e])]);
    }
    for (int child : children[p])
      for (int v : below[at(child)])
        add(v);
    std::sort(below[p].begin(), below[p].end());
    if (!below[p].empty() && below[p].front() < m)
      children[at(pieceOf[at(below[p].front())])].push_back(static_cast<int>(p));
  }
  return below;
}

} // namespace

FrontTree::FrontTree(const LocalMatrix& pattern, const std::vector<int>& rest, Rest use,
                     const FrontTree* like)
    : remaining(use == Rest::Stays ? static_cast<int>(rest.size()) : 0) {
  const Quotient q = quotientOf(pattern, rest, use);
  const int m = q.size() - q.remaining;
  std::vector<int> vertices = like != nullptr ? orderOf(*like, q) : std::vector<int>();
  if (vertices.empty())
    vertices = nestedDissection(q);
  std::vector<int> places = inverseOf(vertices, vertices.size()), parent(at(m));
  {
    const std::vector<int> before = eliminationTree(q, vertices, places, m), sequence = postorder(before),
                           old = vertices;
    std::vector<int> now = inverseOf(sequence, sequence.size());
    now.push_back(m);
    for (std::size_t k = 0; k < sequence.size(); ++k) {
      vertices[k] = old[at(sequence[k])];
      parent[k] = now[at(before[at(sequence[k])])];
    }
    places = inverseOf(vertices, vertices.size());
  }
  const std::vector<Piece> all = pieces(q, vertices, parent, columnCounts(q, vertices, places, parent));
  const std::vector<std::vector<int>> below = verticesBelow(q, vertices, places, all);

  std::vector<int> start; // place of the first row of each vertex
  for (int v : vertices) {
    start.push_back(size());
    for (int k = 0; k < q.weight[at(v)]; ++k)
      order.push_back(q.first[at(v)] + k);
  }
  place = inverseOf(order, at(pattern.rows()));
  std::vector<int> frontAt(at(eliminated()));
  std::vector<std::size_t> onStack(all.size(), 0);
  std::size_t stack = 0;
  for (std::size_t f = 0; f < all.size(); ++f) {
    Front front;
    front.first = start[at(all[f].first)];
    front.columns = all[f].columns;
    front.rows = rows.size();
    for (int j : below[f])
      for (int k = 0; k < q.weight[at(vertices[at(j)])]; ++k)
        rows.push_back(start[at(j)] + k);
    front.below = static_cast<int>(rows.size() - front.rows);
    std::fill(frontAt.begin() + front.first, frontAt.begin() + front.first + front.columns,
              static_cast<int>(f));
    fronts.push_back(front);
  }
  for (std::size_t f = 0; f < fronts.size(); ++f) {
    Front& front = fronts[f];
    stack -= onStack[f]; // of its children
    if (front.below > 0 && rows[front.rows] < eliminated()) {
      front.parent = frontAt[at(rows[front.rows])];
      const std::size_t left = at(front.below) * at(front.below);
      onStack[at(front.parent)] += left;
      stack += left;
    }
    stackEntries = std::max(stackEntries, stack);
    front.entries = factorEntries;
    while (front.inner < front.below && rows[front.rows + at(front.inner)] < eliminated())
      ++front.inner;
    for (int j = 0; j < front.columns; j += panelColumns)
      factorEntries += at(front.height() - j) * at(std::min(panelColumns, front.columns - j));
    largestFront = std::max(largestFront, front.columns + front.below);
    const double k = front.columns, r = front.below;
    flops += k * k * k / 3.0 + k * k * r + k * r * r;
  }
}

std::vector<char> FrontTree::reachedFrom(const std::vector<int>& matrixRows) const {
  std::vector<char> isHeld(at(size()), 0), reached(fronts.size(), 0);
  for (int row : matrixRows)
    if (place[at(row)] >= 0)
      isHeld[at(place[at(row)])] = 1;
  for (std::size_t f = 0; f < fronts.size(); ++f) {
    const Front& front = fronts[f];
    for (int j = 0; j < front.columns; ++j)
      reached[f] |= isHeld[at(front.first + j)];
    if (reached[f] && front.parent >= 0)
      reached[at(front.parent)] = 1;
  }
  return reached;
}

double FrontTree::entriesOf(const std::vector<char>& reached) const {
  double sum = 0.0;
  for (std::size_t f = 0; f < fronts.size(); ++f)
    if (reached[f]) {
      const double k = fronts[f].columns;
      sum += 0.5 * k * (k + 1.0) + k * fronts[f].inner;
    }
  return sum;
}

} // namespace Harmos::feti
