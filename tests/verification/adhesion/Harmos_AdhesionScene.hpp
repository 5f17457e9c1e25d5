// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Adhesion.hpp"
#include "Harmos_Contact.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

/// What the tests of adhesion share.
namespace Harmos {

using effects::CohesiveLaw;

inline std::shared_ptr<const scene::Effect> joint(scene::Scene& scene) {
  effects::SurfacePair pair;
  pair.first = {1, "bottom"};
  pair.second = {0, "top"};
  const auto contact = std::make_shared<effects::Contact>(pair, 0.0, "joint");
  scene.effects.push_back(contact);
  return contact;
}

inline CohesiveLaw::Options softLaw() {
  CohesiveLaw::Options law;
  law.normalStiffness = 100.0;
  law.tangentialStiffness = 60.0;
  law.normalStrength = 1.0;
  law.tangentialStrength = 0.8;
  law.fractureEnergy = 0.05;
  law.fractureEnergyII = 0.08;
  return law;
}

inline std::vector<double> upTo(std::size_t count) {
  std::vector<double> result;
  for (std::size_t k = 1; k <= count; ++k)
    result.push_back(static_cast<double>(k));
  return result;
}

inline double defect(const run::StepRow& row) {
  return row.externalWork - row.energy - row.dissipated - row.released;
}

// All along: work is stored, dissipated or released, but for an energy; nothing heals.
// @return the most that was missing.
inline double expectEnergies(const std::vector<run::StepRow>& rows, double allowed) {
  double most = 0.0;
  run::StepRow before;
  for (const run::StepRow& row : rows) {
    most = std::max(most, std::abs(defect(row)));
    EXPECT_NEAR(defect(row), 0.0, allowed) << row.time;
    EXPECT_GE(row.broken, before.broken) << row.time;
    EXPECT_GE(row.released, before.released) << row.time;
    // Where no point is damaged further it is the same number.
    EXPECT_GE(row.dissipated, before.dissipated) << row.time;
    before = row;
  }
  return most;
}

} // namespace Harmos
