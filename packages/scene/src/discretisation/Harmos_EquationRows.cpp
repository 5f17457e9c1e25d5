// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_EquationRows.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Log.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::scene {
namespace {

// Whether all of its dofs are prescribed.
bool isHeld(const ConstraintRow& row, const std::map<double, contact::HeldDofs>& heldByTime,
            const Timeline& timeline, const Effect& effect) {
  for (const auto& [time, held] : heldByTime) {
    const double bound = timeline.factor(effect, time) * row.bound;
    double sum = 0.0, size = std::abs(bound);
    for (const ConstraintRow::Term& term : row.terms) {
      const auto value = held.find(term.dof);
      if (value == held.end())
        return false;
      sum += term.coefficient * value->second;
      size = std::max(size, std::abs(term.coefficient * value->second));
    }
    constexpr double rounding = 1e-9;
    if (std::abs(sum - bound) > rounding * size)
      throw InputError(effect.label() +
                       " contradicts prescribed displacements: all displacements of an equation are "
                       "prescribed, and they make " +
                       scientific(sum) + " in the place of " + scientific(bound) +
                       "; prescribe other values or release one of them");
  }
  return true;
}

} // namespace

std::vector<long long> EquationRows::dofs(int components) const {
  std::vector<long long> result;
  for (const auto& [equation, effect] : equations_)
    for (const Equation::Term& term : equation.terms)
      result.push_back(term.node.number * components + term.component);
  return result;
}

std::vector<EquationRows::Row> EquationRows::rows(const Scene& scene,
                                                  const std::map<double, contact::HeldDofs>& held) const {
  const int components = scene.components();
  std::vector<Row> result;
  for (const auto& [equation, effect] : equations_) {
    Row item;
    item.effect = effect;
    item.row.bound = equation.value;
    for (const Equation::Term& term : equation.terms)
      item.row.terms.push_back({term.node.number * components + term.component, term.coefficient});
    if (item.row.terms.empty() || isHeld(item.row, held, scene.timeline, *effect))
      continue;
    item.position = equation.terms.front().node.position;
    for (const Equation::Term& term : equation.terms)
      if (term.node.number == equation.terms.front().node.number)
        for (std::size_t d = 0; d < 3; ++d)
          item.direction[d] += term.coefficient * directionOf(scene, term.component)[d];
    if (equation.resultant) {
      item.position = equation.resultant->position;
      item.direction = equation.resultant->direction;
      item.counter = equation.resultant->counter;
    }
    item.lockedFrom = equation.lockedFrom;
    if (item.lockedFrom)
      item.row.kind = ConstraintRow::Kind::Limited;
    result.push_back(item);
  }
  return result;
}

} // namespace Harmos::scene
