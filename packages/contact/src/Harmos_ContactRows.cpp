// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactPoint.hpp"
#include "Harmos_Errors.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::contact {
namespace {

// Components of a unit vector below this are rounding errors of its making; a row of them would couple
// dofs that have nothing to do with each other.
constexpr double leastComponent = 1e-14;

bool isMine(const Teuchos::Comm<int>& comm, std::size_t row) {
  return row % static_cast<std::size_t>(comm.getSize()) == static_cast<std::size_t>(comm.getRank());
}

} // namespace

std::vector<ConstraintRow> contactRows(const Teuchos::Comm<int>& comm,
                                       const std::vector<ContactPoint>& points, int components,
                                       long long firstNumber) {
  HARMOS_REQUIRE(components >= 1 && components <= 3, "a node has one to three dofs");
  std::vector<ConstraintRow> rows;
  for (std::size_t k = 0; k < points.size(); ++k) {
    if (!isMine(comm, k))
      continue;
    ConstraintRow row;
    row.kind = ConstraintRow::Kind::Inequality;
    row.number = firstNumber + static_cast<long long>(k);
    row.bound = points[k].gap;
    for (const ContactPoint::Term& term : points[k].terms)
      for (int c = 0; c < components; ++c) {
        const double direction = components == 1 ? 1.0 : points[k].normal[static_cast<std::size_t>(c)];
        if (std::abs(direction) > leastComponent)
          row.terms.push_back({term.node * components + c, term.weight * direction});
      }
    rows.push_back(row);
  }
  return rows;
}

TieRows tieRows(const Teuchos::Comm<int>& comm, const std::vector<ContactPoint>& points, int components,
                long long firstNumber, const std::set<long long>& held) {
  HARMOS_REQUIRE(components >= 1 && components <= 3, "a node has one to three dofs");
  TieRows result;
  for (const ContactPoint& point : points)
    for (int c = 0; c < components; ++c) {
      const auto isHeld = [&](long long node) { return held.count(node * components + c) > 0; };
      const bool bothHeld =
          isHeld(point.node) && std::any_of(point.terms.begin(), point.terms.end(), [&](const auto& term) {
            return term.node != point.node && isHeld(term.node);
          });
      if (bothHeld)
        continue;
      if (isMine(comm, static_cast<std::size_t>(result.count))) {
        ConstraintRow row;
        row.kind = ConstraintRow::Kind::Equality;
        row.number = firstNumber + result.count;
        for (const ContactPoint::Term& term : point.terms)
          row.terms.push_back({term.node * components + c, term.weight});
        result.rows.push_back(row);
      }
      ++result.count;
    }
  return result;
}

} // namespace Harmos::contact
