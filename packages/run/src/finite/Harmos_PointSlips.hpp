// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactFields.hpp"
#include "Harmos_ContactSetup.hpp"
#include "Harmos_SolverMonitor.hpp"
#include "Harmos_Types.hpp"

#include <map>
#include <tuple>
#include <vector>

namespace Harmos::run {

/// How far points of friction have slipped since the run began, where contacts come and go: measured along
/// the way, step by step, and kept by effect, node and side. A point that opens keeps what it has. Where the
/// surface turns, what lies along its tangents counts on.
class PointSlips {
 public:
  /// Of scenes with these effects, which have to outlive it.
  explicit PointSlips(const scene::Scene& scene) : scene_(&scene) {}

  /// Of the limited rows of this rank, along their tangents. Local.
  std::vector<double> of(const scene::ContactSetup& contact) const;
  /// @param states of the points of the contact. Local.
  void keep(const scene::ContactSetup& contact, const std::vector<ContactState>& states);
  /// For checkpoints. @note Collective.
  void exchange(const Teuchos::Comm<int>& comm, qp::StateArchive<MultiVector>& archive);

 private:
  using Key = std::tuple<std::size_t, long long, int>; // effect, node, side
  Key keyOf(const scene::ContactSetup& contact, std::size_t point) const;

  const scene::Scene* scene_;
  std::map<Key, fem::Point> slips_; // of this rank
};

} // namespace Harmos::run
