// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ContactPoint.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_PointAlgebra.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace Harmos::contact {
namespace {

// Components of a unit vector below this are rounding errors of its making; a row of them would couple
// dofs that have nothing to do with each other.
constexpr double leastComponent = 1e-14;

// Σ weight · direction · u.
void addTerms(const ContactPoint& point, const fem::Point& direction, int components, ConstraintRow& row) {
  for (const ContactPoint::Term& term : point.terms)
    for (int c = 0; c < components; ++c) {
      const double along = components == 1 ? 1.0 : direction[static_cast<std::size_t>(c)];
      if (std::abs(along) > leastComponent)
        row.terms.push_back({term.node * components + c, term.weight * along});
    }
}

// Gaps are differences of coordinates; some thousand times their rounding errors.
constexpr double roundingOfExtent = 1e-12;

// A row whose own dof is held compares prescribed values if at most this of its counterparts' weight is free;
// a half, as opposite to the middle of an edge with one end held, is among it.
constexpr double mostFree = 0.5 + 1e-9;

// What the prescribed values of one component make of a point's row.
struct HeldRow {
  // Σ weights of what is free, with their signs: how far the row follows if all that moves on. A sum of
  // magnitudes would count what mortar coupling of second order, or next to nodes that another effect holds,
  // has of nodes further inside, in weights of both signs: such a row says nothing of the dof it stands for,
  // and the force that it is given is arbitrary.
  double follows = 0.0;
  double freeWeight = 0.0; // Σ their magnitudes
  double difference = 0.0; // Σ weight · prescribed value
  double size = 0.0;       // largest of these values, and of its own
  bool areEqual = true;    // these values
  bool isAlone = true;     // no node but its own
  bool anyCounterpart = false;
};

// None if the point's own dof is free.
std::optional<HeldRow> heldRow(const ContactPoint& point, int components, int component,
                               const HeldDofs& held) {
  const auto own = held.find(point.node * components + component);
  if (own == held.end())
    return std::nullopt;
  HeldRow row;
  row.size = std::abs(own->second);
  for (const ContactPoint::Term& term : point.terms) {
    row.isAlone = row.isAlone && term.node == point.node;
    const auto value = held.find(term.node * components + component);
    if (value == held.end()) {
      row.follows += term.weight;
      row.freeWeight += std::abs(term.weight);
      continue;
    }
    row.anyCounterpart = row.anyCounterpart || term.node != point.node;
    row.areEqual = row.areEqual && value->second == own->second;
    row.difference += term.weight * value->second;
    row.size = std::max(row.size, std::abs(value->second));
  }
  return row;
}

bool isHeldOnBothSides(const ContactPoint& point, int components, int component, const HeldDofs& held) {
  const std::optional<HeldRow> row = heldRow(point, components, component, held);
  if (!row)
    return false;
  constexpr double rounding = 1e-9;
  if (row->anyCounterpart && row->freeWeight <= rounding && std::abs(row->difference) > rounding * row->size)
    throw InputError("a tie contradicts prescribed displacements: both sides are fixed at node " +
                         std::to_string(point.node) + ", to values that differ by " +
                         scientific(std::abs(row->difference)) + " in component " +
                         std::to_string(component) + "; prescribe equal values or release one side there",
                     {{"node", std::to_string(point.node)}});
  return row->anyCounterpart && std::abs(row->follows) <= mostFree;
}

// The same, and by one value; on an obstacle by none.
bool isHeldAlike(const ContactPoint& point, int components, int component, const HeldDofs& held) {
  const std::optional<HeldRow> row = heldRow(point, components, component, held);
  if (!row)
    return false;
  return row->isAlone ? row->size == 0.0 : row->areEqual && std::abs(row->follows) <= mostFree;
}

// Tangents at a point, in the plane one.
std::vector<fem::Point> tangentsTo(const fem::Point& normal, int components) {
  if (components == 2)
    return {fem::Point{-normal[1], normal[0], 0.0}};
  std::size_t farthest = 0;
  for (std::size_t d = 1; d < 3; ++d)
    if (std::abs(normal[d]) < std::abs(normal[farthest]))
      farthest = d;
  fem::Point axis{};
  axis[farthest] = 1.0;
  const fem::Point across = cross(normal, axis);
  const fem::Point first = scaled(1.0 / norm(across), across);
  return {first, cross(normal, first)};
}

} // namespace

double extentOf(const Teuchos::Comm<int>& comm, const std::vector<ContactPoint>& points) {
  double largest = 0.0;
  for (const ContactPoint& point : points)
    for (double coordinate : point.position)
      largest = std::max(largest, std::abs(coordinate));
  return globalMax(comm, largest);
}

bool touches(double gap, double extent) {
  return std::abs(gap) <= samePlace * extent;
}

std::vector<ConstraintRow> contactRows(const std::vector<ContactPoint>& points, int components,
                                       double extent) {
  HARMOS_REQUIRE(components >= 1 && components <= 3, "a node has one to three dofs");
  std::vector<ConstraintRow> rows;
  for (const ContactPoint& point : points) {
    ConstraintRow row;
    row.kind = ConstraintRow::Kind::Inequality;
    row.number = point.number;
    row.bound = point.gap;
    row.rounding = roundingOfExtent * extent;
    row.compliance = point.compliance;
    addTerms(point, point.normal, components, row);
    rows.push_back(row);
  }
  return rows;
}

std::vector<fem::Point> slipDirections(const ContactPoint& point, int components,
                                       const std::map<double, HeldDofs>& held) {
  constexpr double mostAlong = 0.5; // of the normal
  std::vector<fem::Point> across;
  for (int c = 0; c < components; ++c) {
    const auto isAlike = [&](const auto& timed) { return isHeldAlike(point, components, c, timed.second); };
    if (std::abs(point.normal[static_cast<std::size_t>(c)]) > mostAlong || held.empty() ||
        !std::all_of(held.begin(), held.end(), isAlike))
      continue;
    across.push_back({});
    across.back()[static_cast<std::size_t>(c)] = 1.0;
  }
  if (across.empty())
    return tangentsTo(point.normal, components);
  if (static_cast<int>(across.size()) >= components - 1)
    return {};
  const fem::Point along = cross(point.normal, across.front());
  return {scaled(1.0 / norm(along), along)};
}

std::vector<ConstraintRow> slipRows(const std::vector<ContactPoint>& points,
                                    const std::vector<SlipPoint>& slips, int components, double extent) {
  HARMOS_REQUIRE(components == 2 || components == 3, "only elastic bodies slip");
  std::vector<ConstraintRow> rows;
  for (const SlipPoint& slip : slips)
    for (std::size_t t = 0; t < slip.tangents.size(); ++t) {
      ConstraintRow row;
      row.kind = ConstraintRow::Kind::Limited;
      row.number = slip.firstRow + static_cast<long long>(t);
      row.rounding = roundingOfExtent * extent;
      row.limit = slip.limit;
      if (slip.follows) {
        row.coefficient = slip.coefficient;
        row.normal = points[slip.point].number;
      }
      row.disc = slip.tangents.size() == 2 ? slip.firstRow : -1;
      addTerms(points[slip.point], slip.tangents[t], components, row);
      rows.push_back(row);
    }
  return rows;
}

std::vector<int> tiedComponents(const ContactPoint& point, int components, const HeldDofs& held) {
  HARMOS_REQUIRE(components >= 1 && components <= 3, "a node has one to three dofs");
  std::vector<int> result;
  for (int c = 0; c < components; ++c)
    if (!isHeldOnBothSides(point, components, c, held))
      result.push_back(c);
  return result;
}

ConstraintRow tieRow(const ContactPoint& point, int component, int components, long long number) {
  ConstraintRow row;
  row.kind = ConstraintRow::Kind::Equality;
  row.number = number;
  for (const ContactPoint::Term& term : point.terms)
    row.terms.push_back({term.node * components + component, term.weight});
  return row;
}

} // namespace Harmos::contact
