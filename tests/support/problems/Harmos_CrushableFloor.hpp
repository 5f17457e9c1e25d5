// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ConstraintCollector.hpp"
#include "Harmos_Effect.hpp"

#include <algorithm>

namespace Harmos {

/// An effect with state, for tests: a floor y = 0 under a part of a body in the plane that gives way where
/// the pressure is more than its strength, and does not come back. What has been crushed is its state, a
/// depth for each row.
class CrushableFloor : public scene::Effect, public scene::InterfaceLaw {
 public:
  /// @param stiffness pressure beyond the strength over the depth that one update adds: well above that of
  /// the body for the updates to settle.
  CrushableFloor(int body, std::string set, double strength, double stiffness)
      : Effect("Crushable floor", "floor"),
        body_(body),
        set_(std::move(set)),
        strength_(strength),
        stiffness_(stiffness) {}

  std::vector<BoundaryPart> boundaryParts() const override { return {{body_, set_, true}}; }
  bool givesInequalities() const override { return true; }
  void addConstraints(scene::ConstraintCollector& collector) const override {
    contact::Obstacle floor;
    floor.direction = {0.0, 1.0, 0.0};
    collector.addContacts(contact::obstaclePoints(collector.surface(body_, set_), floor));
  }

  const scene::InterfaceLaw* interfaceLaw() const override { return this; }
  std::size_t stateSize() const override { return 1; }
  void addToBounds(const scene::PointStates& state, const std::vector<Row>& rows,
                   std::vector<double>& bounds) const override {
    for (std::size_t k = 0; k < bounds.size(); ++k)
      bounds[k] += state.get<double>(rows[k].place);
  }
  bool updateState(const std::vector<RowAnswer>& answer, double, const Largest&,
                   scene::PointStates& trial) const override {
    bool again = false;
    for (const RowAnswer& row : answer) {
      const double excess = row.force / row.point->area - strength_;
      if (excess <= accuracy * strength_)
        continue;
      trial.set(row.place, trial.get<double>(row.place) + excess / stiffness_);
      again = true;
    }
    return again;
  }

  static constexpr double accuracy = 1e-7; ///< of the pressure, relative

 private:
  int body_;
  std::string set_;
  double strength_, stiffness_;
};

} // namespace Harmos
