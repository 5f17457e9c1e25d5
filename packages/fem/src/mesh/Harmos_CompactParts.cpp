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

// Of cells, or of clusters of them.
class Sweeps {
 public:
  /// @param counts cells of each; empty: one.
  Sweeps(const CellGraph& graph, const std::vector<Point>& centres, const std::vector<int>& counts, int parts,
         std::vector<int>& labels)
      : graph_(graph),
        labels_(labels),
        centres_(centres),
        counts_(counts),
        sizes_(at(parts), 0),
        weights_(at(parts), 0.0),
        queued_(at(graph.cells()), 0) {
    count();
    wanted_ = sizes_;
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
    for (int k = 0; k < votes && vote(); ++k) {
    }
  }

 private:
  int countOf(std::size_t cell) const { return counts_.empty() ? 1 : counts_[cell]; }

  void count() {
    std::fill(sizes_.begin(), sizes_.end(), 0);
    for (std::size_t c = 0; c < labels_.size(); ++c)
      sizes_[at(labels_[c])] += countOf(c);
  }

  // Centroids, and weights by how far the parts are from their sizes.
  void measure() {
    centroids_.assign(sizes_.size(), Point{});
    for (std::size_t c = 0; c < labels_.size(); ++c)
      for (std::size_t d = 0; d < 3; ++d)
        centroids_[at(labels_[c])][d] += countOf(c) * centres_[c][d] / sizes_[at(labels_[c])];
    std::vector<double> spread(sizes_.size(), 0.0); // mean square of the distance
    for (std::size_t c = 0; c < labels_.size(); ++c)
      spread[at(labels_[c])] +=
          countOf(c) * distance2(centres_[c], centroids_[at(labels_[c])]) / sizes_[at(labels_[c])];
    // A ball's boundary moves by R f/3 for a share f of its cells, and the weights it takes for that differ
    // by some 4/3 R² f = 2 f spread; parts are moved by a part of it only, for their neighbours move too.
    constexpr double pace = 0.5;
    // A small part among large ones grows on their scale, or they would swallow it.
    std::vector<double> scale = spread;
    for (int cell = 0; cell < graph_.cells(); ++cell)
      for (const int* other = graph_.begin(cell); other != graph_.end(cell); ++other)
        scale[at(labels_[at(cell)])] =
            std::max(scale[at(labels_[at(cell)])], spread[at(labels_[at(*other)])]);
    for (std::size_t p = 0; p < sizes_.size(); ++p) {
      const double excess = 1.0 - static_cast<double>(sizes_[p]) / wanted_[p];
      weights_[p] += pace * (excess > 0.0 ? scale[p] : spread[p]) * excess;
    }
  }

  // The largest factor between what a part has of cells and what it had at first.
  double imbalance() const {
    double worst = 1.0;
    for (std::size_t p = 0; p < sizes_.size(); ++p) {
      const double ratio = static_cast<double>(sizes_[p]) / wanted_[p];
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
    std::vector<int> queue;
    for (int cell = 0; cell < graph_.cells(); ++cell)
      if (isAtBoundary(cell)) {
        queue.push_back(cell);
        queued_[at(cell)] = 1;
      }
    // Weighted distances fall with each move, so that there is an end.
    bool moved = false;
    for (std::size_t k = 0; k < queue.size(); ++k) {
      const int cell = queue[k];
      queued_[at(cell)] = 0;
      const int best = nearest(cell);
      if (best == labels_[at(cell)] || sizes_[at(labels_[at(cell)])] == countOf(at(cell)))
        continue;
      move(cell, best);
      moved = true;
      for (const int* other = graph_.begin(cell); other != graph_.end(cell); ++other)
        if (queued_[at(*other)] == 0 && labels_[at(*other)] != best) {
          queued_[at(*other)] = 1;
          queue.push_back(*other);
        }
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
    return distance2(centres_[at(cell)], centroids_[at(part)]) - weights_[at(part)];
  }

  void move(int cell, int part) {
    sizes_[at(labels_[at(cell)])] -= countOf(at(cell));
    sizes_[at(part)] += countOf(at(cell));
    labels_[at(cell)] = part;
  }

  // Whether neither the cell nor one of its neighbours has more than two.
  bool isInRow(int cell) const {
    const auto few = [this](int c) { return graph_.end(c) - graph_.begin(c) <= 2; };
    return few(cell) && std::all_of(graph_.begin(cell), graph_.end(cell), few);
  }

  // Whether any has moved.
  bool vote() {
    bool moved = false;
    for (int cell = 0; cell < graph_.cells(); ++cell) {
      if (sizes_[at(labels_[at(cell)])] == 1)
        continue;
      const auto sidesWith = [&](int part) {
        int sides = 0;
        for (const int* other = graph_.begin(cell); other != graph_.end(cell); ++other)
          sides += labels_[at(*other)] == part ? 1 : 0;
        return sides;
      };
      int best = labels_[at(cell)], most = sidesWith(best);
      // A cell that hangs by one side is soft; but in a row of cells all do at the end of a part, and one
      // after the other would leave it.
      if (most == 1 && !isInRow(cell))
        most = 0;
      for (const int* other = graph_.begin(cell); other != graph_.end(cell); ++other) {
        const int sides = sidesWith(labels_[at(*other)]);
        if (sides > most) {
          most = sides;
          best = labels_[at(*other)];
        }
      }
      if (best != labels_[at(cell)]) {
        move(cell, best);
        moved = true;
      }
    }
    return moved;
  }

  const CellGraph& graph_;
  std::vector<int>& labels_;
  const std::vector<Point>& centres_;
  const std::vector<int>& counts_;
  std::vector<Point> centroids_;
  std::vector<int> sizes_, wanted_;
  std::vector<double> weights_;
  std::vector<std::uint8_t> queued_;
};

} // namespace

void roundOff(const CellGraph& graph, const std::vector<Point>& centres, int parts, std::vector<int>& labels,
              const CellClusters* clusters) {
  constexpr int most = 50, mostAfterClusters = 12;
  static const std::vector<int> one; // cell each
  if (clusters == nullptr) {
    Sweeps sweeps(graph, centres, one, parts, labels);
    sweeps.go(most);
    sweeps.smooth();
    return;
  }
  std::vector<int> ofClusters(clusters->sizes.size());
  for (std::size_t c = 0; c < labels.size(); ++c)
    ofClusters[at(clusters->of[c])] = labels[c];
  Sweeps coarse(clusters->graph, clusters->centres, clusters->sizes, parts, ofClusters);
  coarse.go(most);
  for (std::size_t c = 0; c < labels.size(); ++c)
    labels[c] = ofClusters[at(clusters->of[c])];
  Sweeps sweeps(graph, centres, one, parts, labels);
  sweeps.goOnAfter(coarse);
  sweeps.go(mostAfterClusters);
  sweeps.smooth();
}

} // namespace Harmos::fem
