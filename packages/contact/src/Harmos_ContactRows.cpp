// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactPoint.hpp"
#include "Harmos_Errors.hpp"

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

std::vector<ConstraintRow> tieRows(const Teuchos::Comm<int>& comm, const std::vector<ContactPoint>& points,
                                   int components, long long firstNumber) {
  HARMOS_REQUIRE(components >= 1 && components <= 3, "a node has one to three dofs");
  std::vector<ConstraintRow> rows;
  const auto width = static_cast<std::size_t>(components);
  for (std::size_t k = 0; k < points.size() * width; ++k) {
    if (!isMine(comm, k))
      continue;
    ConstraintRow row;
    row.kind = ConstraintRow::Kind::Equality;
    row.number = firstNumber + static_cast<long long>(k);
    for (const ContactPoint::Term& term : points[k / width].terms)
      row.terms.push_back({term.node * components + static_cast<long long>(k % width), term.weight});
    rows.push_back(row);
  }
  return rows;
}

} // namespace Harmos::contact
