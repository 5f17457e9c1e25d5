// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactPoint.hpp"
#include "Harmos_Effect.hpp"

#include <Teuchos_Comm.hpp>

#include <vector>

namespace Harmos::scene {

/// Points whose rows differ. Effects that overlap give the same row twice, perhaps with the surfaces
/// exchanged; two of them would be dependent, and of contacts the one with the smaller gap is enough. Such
/// points meet at the rank of their lowest node, and the one that is kept stays where it came from.
class DistinctPoints {
 public:
  /// @param normalsMatter not for ties, which have rows in every direction, nor for scalar problems.
  explicit DistinctPoints(bool normalsMatter) : normalsMatter_(normalsMatter) {}

  /// This rank's points of an effect; all ranks ask for the same effects in the same order. Local.
  void add(const std::vector<contact::ContactPoint>& more, const Effect& effect);
  /// Leaves out what is there twice, and numbers the others: by effects, then by nodes. @note Collective.
  void finish(const Teuchos::Comm<int>& comm);

  // After that.

  const std::vector<contact::ContactPoint>& all() const { return all_; }
  /// On all ranks.
  long long count() const { return count_; }
  /// The one that named a point first.
  const Effect& effect(std::size_t point) const { return *batches_[effects_[point].front()]; }
  /// All that named it, in their order.
  std::vector<const Effect*> effectsAt(std::size_t point) const;

 private:
  struct Kept {
    std::size_t point;                // of those that were added
    double gap;                       // the smallest
    std::vector<std::size_t> batches; // the first one's, and those of others
  };
  bool sameRow(const contact::ContactPoint& a, const contact::ContactPoint& b) const;
  void numberPressures(const Teuchos::Comm<int>& comm);
  std::vector<Kept> distinct(const Teuchos::Comm<int>& comm) const;

  bool normalsMatter_;
  std::vector<const Effect*> batches_; // of each call of add()
  std::vector<contact::ContactPoint> all_;
  std::vector<std::vector<std::size_t>> effects_; // places in batches_ of each point
  long long count_ = 0;
};

} // namespace Harmos::scene
