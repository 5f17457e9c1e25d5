// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_PartShape.hpp"

#include "Harmos_Index.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <tuple>
#include <utility>

namespace Harmos::fem {
namespace {

constexpr std::size_t mostVectors = 4; // vectors at a time
using Values = std::array<double, mostVectors>;
using Vectors = std::vector<Values>; // a number of each vector at every cell

// The graph of a part by itself.
CellGraph partOf(const CellGraph& graph, const std::vector<int>& cells, const std::vector<int>& number) {
  CellGraph part;
  part.offsets.push_back(0);
  for (int cell : cells) {
    for (const int* other = graph.begin(cell); other != graph.end(cell); ++other)
      if (number[at(*other)] >= 0)
        part.neighbours.push_back(number[at(*other)]);
    part.offsets.push_back(part.neighbours.size());
  }
  return part;
}

double degree(const CellGraph& part, int k) {
  return static_cast<double>(part.end(k) - part.begin(k));
}

// Takes the means off, weighted by the degrees: with L = D − A the constant is the vector of eigenvalue 0.
void removeConstants(const CellGraph& part, Vectors& x) {
  Values mean{};
  for (int k = 0; k < part.cells(); ++k)
    for (std::size_t d = 0; d < mostVectors; ++d)
      mean[d] += degree(part, k) * x[at(k)][d] / static_cast<double>(part.neighbours.size());
  for (Values& values : x)
    for (std::size_t d = 0; d < mostVectors; ++d)
      values[d] -= mean[d];
}

// Chebyshev polynomials of D⁻¹L, at most one in magnitude for eigenvalues from `least` to 2, large below.
void smooth(const CellGraph& part, double least, int steps, Vectors& x) {
  // Tₖ₊₁ = 2 t Tₖ − Tₖ₋₁, where t = ((2 + least) − 2 D⁻¹L)/(2 − least).
  const double own = least / (2.0 - least), others = 2.0 / (2.0 - least);
  Vectors before = x;
  for (int step = 0; step < steps; ++step) {
    const double factor = step == 0 ? 1.0 : 2.0;
    for (int k = 0; k < part.cells(); ++k) {
      Values sum{};
      for (const int* other = part.begin(k); other != part.end(k); ++other)
        for (std::size_t d = 0; d < mostVectors; ++d)
          sum[d] += x[at(*other)][d];
      const double mean = others / degree(part, k);
      for (std::size_t d = 0; d < mostVectors; ++d)
        before[at(k)][d] =
            factor * (own * x[at(k)][d] + mean * sum[d]) - (step == 0 ? 0.0 : before[at(k)][d]);
    }
    std::swap(x, before);
  }
}

using Matrix = std::array<Values, mostVectors>;

// Jacobi's rotations: eigenvectors are the columns of the result.
Matrix eigenvectors(Matrix a) {
  Matrix v{};
  for (std::size_t k = 0; k < mostVectors; ++k)
    v[k][k] = 1.0;
  constexpr int sweeps = 10; // converges quadratically
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (std::size_t p = 0; p + 1 < mostVectors; ++p)
      for (std::size_t q = p + 1; q < mostVectors; ++q) {
        if (a[p][q] == 0.0)
          continue;
        const double angle = 0.5 * std::atan2(2.0 * a[p][q], a[q][q] - a[p][p]);
        const double c = std::cos(angle), s = std::sin(angle);
        for (std::size_t k = 0; k < mostVectors; ++k)
          std::tie(a[k][p], a[k][q]) = std::pair(c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]);
        for (std::size_t k = 0; k < mostVectors; ++k)
          std::tie(a[p][k], a[q][k]) = std::pair(c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
        for (std::size_t k = 0; k < mostVectors; ++k)
          std::tie(v[k][p], v[k][q]) = std::pair(c * v[k][p] - s * v[k][q], s * v[k][p] + c * v[k][q]);
      }
  return v;
}

// Makes the vectors orthonormal with respect to the degrees; those that depend on others become zero.
void orthonormalise(const CellGraph& part, Vectors& x) {
  const auto product = [&](std::size_t a, std::size_t b) {
    double sum = 0.0;
    for (int k = 0; k < part.cells(); ++k)
      sum += degree(part, k) * x[at(k)][a] * x[at(k)][b];
    return sum;
  };
  for (std::size_t a = 0; a < mostVectors; ++a) {
    const double before = product(a, a);
    for (std::size_t b = 0; b < a; ++b) {
      const double share = product(a, b);
      for (Values& values : x)
        values[a] -= share * values[b];
    }
    // What is left of a vector in the space of the others is rounding errors, some 1e-16 of it.
    constexpr double dependent = 1e-20;
    const double after = product(a, a);
    const double factor = after > dependent * before ? 1.0 / std::sqrt(after) : 0.0;
    for (Values& values : x)
      values[a] *= factor;
  }
}

// Of the space of the vectors those that vary slowest, second slowest, ...: Rayleigh and Ritz.
void separate(const CellGraph& part, Vectors& x) {
  orthonormalise(part, x);
  Matrix a{};
  for (int k = 0; k < part.cells(); ++k)
    for (const int* other = part.begin(k); other != part.end(k); ++other)
      for (std::size_t p = 0; p < mostVectors; ++p)
        for (std::size_t q = 0; q < mostVectors; ++q)
          a[p][q] += 0.5 * (x[at(k)][p] - x[at(*other)][p]) * (x[at(k)][q] - x[at(*other)][q]);
  const Matrix v = eigenvectors(a);
  for (Values& values : x) {
    const Values old = values;
    values.fill(0.0);
    for (std::size_t p = 0; p < mostVectors; ++p)
      for (std::size_t k = 0; k < mostVectors; ++k)
        values[p] += old[k] * v[k][p];
  }
}

// 1 for the cells of the largest component of those on the side `which`.
std::vector<std::uint8_t> largestPiece(const CellGraph& part, const std::vector<std::uint8_t>& side,
                                       std::uint8_t which) {
  std::vector<std::uint8_t> seen(side.size(), 0);
  std::vector<int> best, piece;
  for (int first = 0; first < part.cells(); ++first) {
    if (seen[at(first)] || side[at(first)] != which)
      continue;
    piece = {first};
    seen[at(first)] = 1;
    for (std::size_t k = 0; k < piece.size(); ++k)
      for (const int* other = part.begin(piece[k]); other != part.end(piece[k]); ++other)
        if (!seen[at(*other)] && side[at(*other)] == which) {
          seen[at(*other)] = 1;
          piece.push_back(*other);
        }
    if (piece.size() > best.size())
      best.swap(piece);
  }
  std::vector<std::uint8_t> result(side.size(), 0);
  for (int k : best)
    result[at(k)] = 1;
  return result;
}

struct Cut {
  double width = std::numeric_limits<double>::infinity();
  std::vector<std::uint8_t> side; // 1: of the smaller one
};

// The least width of all cuts in the order of a vector's values, with sides that hang together.
class Sweep {
 public:
  Sweep(const CellGraph& part, int dimension, int leastCells)
      : part_(part), dimension_(dimension), leastCells_(leastCells), order_(at(part.cells())) {}

  Cut alongVector(const Vectors& x, std::size_t vector) {
    for (int k = 0; k < part_.cells(); ++k)
      order_[at(k)] = {x[at(k)][vector], k};
    std::sort(order_.begin(), order_.end());
    const int cells = part_.cells();
    std::vector<std::uint8_t> taken(at(cells), 0);
    int across = 0, best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k + leastCells_ < cells; ++k) {
      const int cell = order_[at(k)].second;
      taken[at(cell)] = 1;
      for (const int* other = part_.begin(cell); other != part_.end(cell); ++other)
        across += taken[at(*other)] ? -1 : 1;
      if (k + 1 < leastCells_)
        continue;
      // The width to the power d, which needs no roots.
      const double smaller = std::min(k + 1, cells - k - 1);
      const double power = dimension_ == 2
                               ? static_cast<double>(across) * across / smaller
                               : static_cast<double>(across) * across * across / (smaller * smaller);
      if (power < least) {
        least = power;
        best = k + 1;
      }
    }
    if (best == 0)
      return {};
    const bool prefix = 2 * best <= cells;
    std::vector<std::uint8_t> side(at(cells), prefix ? 0 : 1);
    for (int k = 0; k < best; ++k)
      side[at(order_[at(k)].second)] = prefix ? 1 : 0;
    return inOnePieceEach(side);
  }

 private:
  double widthOf(int across, int cells) const {
    return across / std::pow(std::min(cells, part_.cells() - cells), (dimension_ - 1.0) / dimension_);
  }

  // Splinters join the other side, which they touch: no cut gets wider by that.
  Cut inOnePieceEach(const std::vector<std::uint8_t>& side) const {
    Cut cut;
    cut.side = largestPiece(part_, largestPiece(part_, side, 1), 0);
    int across = 0, cells = 0;
    for (int k = 0; k < part_.cells(); ++k)
      cells += cut.side[at(k)] = 1 - cut.side[at(k)];
    for (int k = 0; k < part_.cells(); ++k)
      for (const int* other = part_.begin(k); other != part_.end(k); ++other)
        across += cut.side[at(k)] > cut.side[at(*other)] ? 1 : 0;
    if (2 * cells > part_.cells()) {
      cells = part_.cells() - cells;
      for (std::uint8_t& value : cut.side)
        value = 1 - value;
    }
    if (cells < leastCells_)
      return {};
    cut.width = widthOf(across, cells);
    return cut;
  }

  const CellGraph& part_;
  int dimension_;
  int leastCells_;
  std::vector<std::pair<double, int>> order_; // values and cells
};

std::vector<int> chosen(const std::vector<int>& cells, const std::vector<std::uint8_t>& side) {
  std::vector<int> result;
  for (std::size_t k = 0; k < cells.size(); ++k)
    if (side[k])
      result.push_back(cells[k]);
  return result;
}

} // namespace

PartShapes::PartShapes(const CellGraph& graph) : graph_(graph), number_(at(graph.cells()), -1) {}

Neck PartShapes::neckOf(const std::vector<int>& cells) {
  for (std::size_t k = 0; k < cells.size(); ++k)
    number_[at(cells[k])] = static_cast<int>(k);
  const CellGraph part = partOf(graph_, cells, number_);
  for (int cell : cells)
    number_[at(cell)] = -1;
  Neck neck;
  const std::vector<std::uint8_t> main = largestPiece(part, std::vector<std::uint8_t>(cells.size(), 1), 1);
  for (std::size_t k = 0; k < cells.size(); ++k)
    if (!main[k])
      neck.cells.push_back(cells[k]);
  if (!neck.cells.empty()) {
    neck.width = 0.0;
    return neck;
  }
  constexpr double tiny = 0.05;
  constexpr int fewest = 8;
  const int leastCells = std::max(fewest, static_cast<int>(std::ceil(tiny * part.cells())));
  if (part.cells() < 2 * leastCells)
    return neck;

  Vectors x;
  for (int cell : cells)
    x.push_back({graph_.centres[at(cell)][0], graph_.centres[at(cell)][1], graph_.centres[at(cell)][2], 0.0});
  removeConstants(part, x);
  // And the square of the distance from the middle, for what is held in the middle of something.
  for (Values& values : x)
    values[3] = values[0] * values[0] + values[1] * values[1] + values[2] * values[2];
  removeConstants(part, x);
  // Of a compact part of n cells the least eigenvalues of D⁻¹L are some 2 n^(−2/d); all of them, and those
  // of ragged parts, lie well below four times as much. Polynomials of this degree are 100 there at least.
  constexpr int mostSteps = 60;
  const double across = std::pow(part.cells(), 1.0 / graph_.dimension);
  const int steps = std::min(mostSteps, static_cast<int>(std::ceil(1.3 * across)));
  const double least = std::min(0.5, 14.0 / (steps * steps));
  smooth(part, least, steps, x);
  removeConstants(part, x);
  separate(part, x);
  Sweep sweep(part, graph_.dimension, leastCells);
  for (std::size_t vector = 0; vector < mostVectors; ++vector) {
    if (std::all_of(x.begin(), x.end(), [=](const Values& values) { return values[vector] == 0.0; }))
      continue; // one of the coordinates, in the plane
    const Cut cut = sweep.alongVector(x, vector);
    if (cut.width < neck.width) {
      neck.width = cut.width;
      neck.cells = chosen(cells, cut.side);
    }
  }
  return neck;
}

std::vector<std::vector<int>> cellsOf(const std::vector<int>& labels, int parts) {
  std::vector<std::vector<int>> cells(at(parts));
  for (std::size_t cell = 0; cell < labels.size(); ++cell)
    cells[at(labels[cell])].push_back(static_cast<int>(cell));
  return cells;
}

std::vector<double> neckWidths(const CellGraph& graph, const std::vector<int>& labels, int parts) {
  std::vector<std::uint8_t> isAlone(at(parts), 1);
  for (int cell = 0; cell < graph.cells(); ++cell)
    for (const int* other = graph.begin(cell); other != graph.end(cell); ++other)
      if (labels[at(*other)] != labels[at(cell)])
        isAlone[at(labels[at(cell)])] = 0;
  PartShapes shapes(graph);
  std::vector<double> widths;
  for (const std::vector<int>& cells : cellsOf(labels, parts))
    widths.push_back(isAlone[widths.size()] ? Neck().width : shapes.neckOf(cells).width);
  return widths;
}

namespace {

class Mending {
 public:
  Mending(const CellGraph& graph, std::vector<int>& labels, std::vector<double>& necks)
      : graph_(graph),
        shapes_(graph),
        labels_(labels),
        necks_(necks),
        cells_(cellsOf(labels, static_cast<int>(necks.size()))) {}

  int go() {
    constexpr int passes = 3;
    int mended = 0, before = -1;
    for (int pass = 0; pass < passes && mended > before; ++pass) {
      before = mended;
      for (std::size_t part = 0; part < necks_.size(); ++part)
        mended += necks_[part] < raggedNeck && mend(part) ? 1 : 0;
    }
    return mended;
  }

 private:
  // Parts beside the cells, those with most sides in common first.
  std::vector<std::size_t> neighbours(const std::vector<int>& cells, std::size_t own) const {
    std::map<std::size_t, int> shared;
    for (int cell : cells)
      for (const int* other = graph_.begin(cell); other != graph_.end(cell); ++other)
        ++shared[at(labels_[at(*other)])];
    shared.erase(own);
    std::vector<std::size_t> parts;
    for (const auto& [part, sides] : shared)
      parts.push_back(part);
    std::stable_sort(parts.begin(), parts.end(),
                     [&](std::size_t a, std::size_t b) { return shared.at(a) > shared.at(b); });
    return parts;
  }

  bool mend(std::size_t part) {
    constexpr double largest = 1.5;
    constexpr std::size_t asked = 3;
    const double average = static_cast<double>(labels_.size()) / static_cast<double>(necks_.size());
    const std::vector<int> given = shapes_.neckOf(cells_[part]).cells;
    std::vector<int> left;
    std::set_difference(cells_[part].begin(), cells_[part].end(), given.begin(), given.end(),
                        std::back_inserter(left));
    const double after = shapes_.neckOf(left).width;
    if (after <= necks_[part])
      return false;
    std::vector<std::size_t> parts = neighbours(given, part);
    parts.resize(std::min(parts.size(), asked));
    for (std::size_t other : parts) {
      std::vector<int> joined;
      std::merge(cells_[other].begin(), cells_[other].end(), given.begin(), given.end(),
                 std::back_inserter(joined));
      if (static_cast<double>(joined.size()) > largest * average)
        continue;
      const double width = shapes_.neckOf(joined).width;
      if (width < raggedNeck)
        continue;
      for (int cell : given)
        labels_[at(cell)] = static_cast<int>(other);
      cells_[part].swap(left);
      cells_[other].swap(joined);
      necks_[part] = after;
      necks_[other] = width;
      return true;
    }
    return false;
  }

  const CellGraph& graph_;
  PartShapes shapes_;
  std::vector<int>& labels_;
  std::vector<double>& necks_;
  std::vector<std::vector<int>> cells_;
};

} // namespace

int mendNecks(const CellGraph& graph, std::vector<int>& labels, std::vector<double>& necks) {
  return Mending(graph, labels, necks).go();
}

} // namespace Harmos::fem
