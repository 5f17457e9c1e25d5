// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ConstraintRow.hpp"
#include "Harmos_ContactPoint.hpp"
#include "Harmos_Scene.hpp"

#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace Harmos::scene {

/// Linear equations of displacements of nodes, Σ coefficient · displacement = value, and their rows. The same
/// on every rank.
/// Guarded by tests/unit/effects/test_linear_constraint.cpp.
class EquationRows {
 public:
  /// A node of the bodies.
  struct Node {
    long long number;
    fem::Point position;
  };
  struct Equation {
    struct Term {
      Node node;
      int component;
      double coefficient;
    };
    std::vector<Term> terms;
    double value = 0.0;
    /// What the effect's force is, where the node of the first term does not say it: λ times a direction at a
    /// place, and against it at another one, where that is given.
    struct Resultant {
      fem::Point position, direction;
      std::optional<fem::Point> counter;
    };
    std::optional<Resultant> resultant = std::nullopt;
    /// Given, it is a row without force up to this time, and afterwards keeps the value that it has then.
    std::optional<double> lockedFrom = std::nullopt;
  };

  void add(const Equation& equation, const Effect& effect) { equations_.push_back({equation, &effect}); }

  /// Of all terms.
  std::vector<long long> dofs(int components) const;

  struct Row {
    ConstraintRow row; ///< not numbered
    const Effect* effect;
    /// Of the node of the first term, whose force is the effect's: Σ c_i e_i over the terms there.
    fem::Point position, direction{};
    std::optional<fem::Point> counter;
    std::optional<double> lockedFrom;
  };
  /// Equations all of whose dofs are prescribed are left out.
  /// @param held prescribed values of these dofs by time. @throws InputError if they contradict an equation.
  std::vector<Row> rows(const Scene& scene, const std::map<double, contact::HeldDofs>& held) const;

 private:
  std::vector<std::pair<Equation, const Effect*>> equations_;
};

} // namespace Harmos::scene
