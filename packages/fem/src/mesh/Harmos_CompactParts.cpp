// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CompactParts.hpp"

#include "Harmos_Index.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace Harmos::fem {
namespace {

double distance2(const Point& a, const Point& b) {
  double sum = 0.0;
  for (std::size_t d = 0; d < 3; ++d)
    sum += (a[d] - b[d]) * (a[d] - b[d]);
  return sum;
}

// Of cells, or of clusters of them. Sums over the cells of a part follow each move, so that a sweep needs to
// look at no cells but those that have a side in common with another part.
class Sweeps {
 public:
  /// @param counts cells of each; empty: one.
  Sweeps(const CellGraph& graph, const std::vector<int>& counts, int parts, std::vector<int>& labels)
      : graph_(graph),
        labels_(labels),
        counts_(counts),
        sums_(at(parts)),
        weights_(at(parts), 0.0),
        marks_(at(graph.cells()), 0) {
    const Point none{};
    origin_ = graph.centres.empty() ? none : graph.centres.front();
    count();
    for (const Sums& sums : sums_)
      wanted_.push_back(sums.cells);
    for (int cell = 0; cell < graph_.cells(); ++cell)
      if (isAtBoundary(cell))
        boundary_.push_back(cell);
  }

  // With the sizes that are wanted, and the weights, of sweeps over clusters of these cells.
  void goOnAfter(const Sweeps& clusters) {
    wanted_ = clusters.wanted_;
    weights_ = clusters.weights_;
  }

  void go(int most) {
    // Weights overshoot where cells differ much in size: of the later sweeps the last one that is balanced,
    // or the most balanced.
    constexpr double balanced = 1.15;
    std::vector<int> best;
    double least = std::numeric_limits<double>::infinity();
    for (int sweep = 0; sweep < most; ++sweep) {
      measure();
      if (!assign())
        break;
      const double score = std::max(balanced, imbalance());
      if (sweep < most / 2 || score > least)
        continue;
      least = score;
      best = labels_;
    }
    if (!best.empty()) {
      labels_ = best;
      count();
    }
  }

  // Cells join the part that most of their sides look at.
  void smooth() {
    constexpr int votes = 10;
    std::fill(marks_.begin(), marks_.end(), std::uint8_t{1});
    for (int k = 0; k < votes && vote(); ++k) {
    }
    std::fill(marks_.begin(), marks_.end(), std::uint8_t{0});
  }

 private:
  // Of the cells of a part; of x and |x|², from the origin.
  struct Sums {
    int cells = 0;
    Point x{};
    double square = 0.0;
  };

  int countOf(std::size_t cell) const { return counts_.empty() ? 1 : counts_[cell]; }

  void add(Sums& sums, int cell, int sign) const {
    const int count = sign * countOf(at(cell));
    const Point& x = graph_.centres[at(cell)];
    sums.cells += count;
    for (std::size_t d = 0; d < 3; ++d)
      sums.x[d] += count * (x[d] - origin_[d]);
    sums.square += count * distance2(x, origin_);
  }

  void count() {
    std::fill(sums_.begin(), sums_.end(), Sums());
    for (int cell = 0; cell < graph_.cells(); ++cell)
      add(sums_[at(labels_[at(cell)])], cell, 1);
  }

  // Centroids, and weights by how far the parts are from their sizes.
  void measure() {
    centroids_.assign(sums_.size(), Point{});
    std::vector<double> spread(sums_.size(), 0.0); // mean square of the distance from the centroid
    for (std::size_t p = 0; p < sums_.size(); ++p) {
      const double cells = sums_[p].cells;
      spread[p] = sums_[p].square / cells;
      for (std::size_t d = 0; d < 3; ++d) {
        const double mean = sums_[p].x[d] / cells;
        centroids_[p][d] = origin_[d] + mean;
        spread[p] -= mean * mean;
      }
      spread[p] = std::max(0.0, spread[p]); // but for rounding errors
    }
    // A ball's boundary moves by R f/3 for a share f of its cells, and the weights it takes for that differ
    // by some 4/3 R² f = 2 f spread; parts are moved by a part of it only, for their neighbours move too.
    constexpr double pace = 0.5;
    // A small part among large ones grows on their scale, or they would swallow it.
    std::vector<double> scale = spread;
    for (int cell : boundary_)
      for (const int* other = graph_.begin(cell); other != graph_.end(cell); ++other)
        scale[at(labels_[at(cell)])] =
            std::max(scale[at(labels_[at(cell)])], spread[at(labels_[at(*other)])]);
    for (std::size_t p = 0; p < sums_.size(); ++p) {
      const double excess = 1.0 - static_cast<double>(sums_[p].cells) / wanted_[p];
      weights_[p] += pace * (excess > 0.0 ? scale[p] : spread[p]) * excess;
    }
  }

  // The largest factor between what a part has of cells and what it had at first.
  double imbalance() const {
    double worst = 1.0;
    for (std::size_t p = 0; p < sums_.size(); ++p) {
      const double ratio = static_cast<double>(sums_[p].cells) / wanted_[p];
      worst = std::max({worst, ratio, 1.0 / ratio});
    }
    return worst;
  }

  bool isAtBoundary(int cell) const {
    for (const int* other = graph_.begin(cell); other != graph_.end(cell); ++other)
      if (labels_[at(*other)] != labels_[at(cell)])
        return true;
    return false;
  }

  // Each cell to the nearest part of those it touches. Whether any has moved.
  bool assign() {
    std::vector<int> queue = boundary_, met = boundary_; // met: what was ever in the queue
    for (int cell : boundary_)
      marks_[at(cell)] = queued | known;
    // Weighted distances fall with each move, so that there is an end.
    bool moved = false;
    for (std::size_t k = 0; k < queue.size(); ++k) {
      const int cell = queue[k];
      marks_[at(cell)] = known;
      const int best = nearest(cell);
      if (best == labels_[at(cell)] || sums_[at(labels_[at(cell)])].cells == countOf(at(cell)))
        continue;
      move(cell, best);
      moved = true;
      for (const int* other = graph_.begin(cell); other != graph_.end(cell); ++other)
        if ((marks_[at(*other)] & queued) == 0 && labels_[at(*other)] != best) {
          if (marks_[at(*other)] == 0)
            met.push_back(*other);
          marks_[at(*other)] = queued | known;
          queue.push_back(*other);
        }
    }
    // A cell that came to the boundary has seen a neighbour leave, and was queued.
    boundary_.clear();
    for (int cell : met) {
      marks_[at(cell)] = 0;
      if (isAtBoundary(cell))
        boundary_.push_back(cell);
    }
    return moved;
  }

  int nearest(int cell) const {
    int best = labels_[at(cell)];
    double least = power(cell, best);
    for (const int* other = graph_.begin(cell); other != graph_.end(cell); ++other) {
      const int part = labels_[at(*other)];
      const double candidate = part == best ? least : power(cell, part);
      if (candidate < least) {
        least = candidate;
        best = part;
      }
    }
    return best;
  }

  double power(int cell, int part) const {
    return distance2(graph_.centres[at(cell)], centroids_[at(part)]) - weights_[at(part)];
  }

  void move(int cell, int part) {
    add(sums_[at(labels_[at(cell)])], cell, -1);
    add(sums_[at(part)], cell, 1);
    labels_[at(cell)] = part;
  }

  // Whether neither the cell nor one of its neighbours has more than two.
  bool isInRow(int cell) const {
    const auto few = [this](int c) { return graph_.end(c) - graph_.begin(c) <= 2; };
    return few(cell) && std::all_of(graph_.begin(cell), graph_.end(cell), few);
  }

  int sidesWith(int cell, int part) const {
    int sides = 0;
    for (const int* other = graph_.begin(cell); other != graph_.end(cell); ++other)
      sides += labels_[at(*other)] == part ? 1 : 0;
    return sides;
  }

  // The marked cells vote: those of which a neighbour has moved since they did. Whether any has moved.
  bool vote() {
    bool moved = false;
    for (int cell = 0; cell < graph_.cells(); ++cell) {
      if (marks_[at(cell)] == 0)
        continue;
      marks_[at(cell)] = 0;
      const int own = labels_[at(cell)];
      if (sums_[at(own)].cells == 1)
        continue;
      int best = own, most = sidesWith(cell, own);
      // A cell that hangs by one side is soft; but in a row of cells all do at the end of a part, and one
      // after the other would leave it.
      if (most == 1 && !isInRow(cell))
        most = 0;
      for (const int* other = graph_.begin(cell); other != graph_.end(cell); ++other) {
        const int sides = sidesWith(cell, labels_[at(*other)]);
        if (sides > most) {
          most = sides;
          best = labels_[at(*other)];
        }
      }
      if (best == own)
        continue;
      move(cell, best);
      moved = true;
      marks_[at(cell)] = 1;
      for (const int* other = graph_.begin(cell); other != graph_.end(cell); ++other)
        marks_[at(*other)] = 1;
    }
    return moved;
  }

  static constexpr std::uint8_t known = 1, queued = 2;

  const CellGraph& graph_;
  std::vector<int>& labels_;
  const std::vector<int>& counts_;
  Point origin_;
  std::vector<Sums> sums_;
  std::vector<Point> centroids_;
  std::vector<int> wanted_; // sizes
  std::vector<double> weights_;
  std::vector<int> boundary_;       // cells at the boundary of their part
  std::vector<std::uint8_t> marks_; // of cells: what assign() has met, who is to vote()
};

} // namespace

void roundOff(const CellGraph& graph, int parts, std::vector<int>& labels, const CellClusters* clusters) {
  constexpr int most = 50, mostAfterClusters = 12;
  static const std::vector<int> one; // cell each
  if (clusters == nullptr) {
    Sweeps sweeps(graph, one, parts, labels);
    sweeps.go(most);
    sweeps.smooth();
    return;
  }
  std::vector<int> ofClusters(clusters->sizes.size());
  for (std::size_t c = 0; c < labels.size(); ++c)
    ofClusters[at(clusters->of[c])] = labels[c];
  Sweeps coarse(clusters->graph, clusters->sizes, parts, ofClusters);
  coarse.go(most);
  for (std::size_t c = 0; c < labels.size(); ++c)
    labels[c] = ofClusters[at(clusters->of[c])];
  Sweeps sweeps(graph, one, parts, labels);
  sweeps.goOnAfter(coarse);
  sweeps.go(mostAfterClusters);
  sweeps.smooth();
}

} // namespace Harmos::fem
