// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CarriedForces.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_PointAlgebra.hpp"
#include "Harmos_Rendezvous.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <optional>
#include <unordered_map>

namespace Harmos::run {

void CarriedForces::clear() {
  isKept_ = false;
  ofPoints_.clear();
  rest_.clear();
}

// Of this rank.
std::vector<CarriedForces::Row> CarriedForces::rowsOf(const feti::Constraints& constraints,
                                                      const scene::ContactSetup& contact) const {
  std::unordered_map<const scene::Effect*, std::size_t> places;
  for (std::size_t k = 0; k < scene_->effects.size(); ++k)
    places[scene_->effects[k].get()] = k;
  const auto keyOf = [&](std::size_t point) {
    return Key(places.at(contact.effects[point]), contact.points[point].node, contact.points[point].side);
  };
  std::vector<Row> rows;
  for (std::size_t k = 0; k < contact.points.size(); ++k)
    rows.push_back(
        {contact.points[k].number, keyOf(k), &contact.rows[k], &contact.points[k].normal, nullptr});
  for (const contact::SlipPoint& slip : contact.slips)
    for (std::size_t t = 0; t < slip.tangents.size(); ++t)
      rows.push_back({constraints.inequalities() + slip.firstRow + static_cast<long long>(t),
                      keyOf(slip.point), &contact.rows[contact.points.size() + slip.firstPlace + t],
                      &contact.points[slip.point].normal, &slip.tangents[t]});
  constexpr int isLock = -1; // no side
  for (std::size_t k = 0; k < contact.locks.size(); ++k)
    if (constraints.rowMap()->getComm()->getRank() == 0) {
      const ConstraintRow& row = contact.rows[contact.locks[k].place];
      rows.push_back({constraints.inequalities() + row.number,
                      Key(places.at(contact.locks[k].effect), static_cast<long long>(k), isLock), &row,
                      nullptr, nullptr});
    }
  return rows;
}

void CarriedForces::keep(const feti::Constraints& constraints, const scene::ContactSetup& contact,
                         const MultiVector& multiplier) {
  clear();
  isKept_ = true;
  std::vector<std::pair<long long, double>> known;
  {
    const auto lambda = multiplier.getLocalViewHost(Tpetra::Access::ReadOnly);
    for (std::size_t r = 0; r < lambda.extent(0); ++r)
      if (const auto row = static_cast<int>(r); feti::isUnconditional(constraints.rowType(row)))
        rest_.push_back(lambda(r, 0));
      else
        known.emplace_back(constraints.rowMap()->getGlobalElement(row),
                           lambda(r, 0) * constraints.rowScale(row));
  }
  const std::vector<Row> rows = rowsOf(constraints, contact);
  std::vector<long long> asked;
  for (const Row& row : rows)
    asked.push_back(row.number);
  const auto forces = lookUp(*constraints.rowMap()->getComm(), known, asked);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const double force = forces[k].value_or(0.0);
    if (force == 0.0)
      continue;
    Force& kept = ofPoints_[rows[k].key];
    if (rows[k].normal != nullptr)
      kept.normal = *rows[k].normal;
    if (rows[k].tangent == nullptr)
      kept.along = force;
    else
      kept.across = sum(kept.across, scaled(force, *rows[k].tangent));
  }
}

namespace {

// Of a row whose bodies do not move from here: 0 − c = softness · λ; nothing of one that is none, or closed.
std::optional<double> springForce(const ConstraintRow& row) {
  if (!row.softness || (row.kind == ConstraintRow::Kind::Inequality && !(row.bound > 0.0)))
    return std::nullopt;
  return -row.bound / *row.softness;
}

} // namespace

Teuchos::RCP<MultiVector> CarriedForces::on(const feti::Constraints& constraints,
                                            const scene::ContactSetup& contact, bool springsFollow) const {
  std::vector<std::pair<long long, double>> known;
  for (const Row& row : rowsOf(constraints, contact)) {
    const bool isPoint = row.normal != nullptr;
    if (const std::optional<double> spring = springsFollow && isPoint ? springForce(*row.row) : std::nullopt)
      known.emplace_back(row.number, *spring);
    else if (const auto found = ofPoints_.find(row.key); found != ofPoints_.end())
      known.emplace_back(row.number, row.tangent == nullptr ? found->second.along
                                                            : dot(turned(found->second.normal, *row.normal,
                                                                         found->second.across),
                                                                  *row.tangent));
  }
  std::vector<long long> asked;
  std::vector<int> places;
  const auto size = static_cast<int>(localSize(*constraints.rowMap()));
  for (int row = 0; row < size; ++row)
    if (!feti::isUnconditional(constraints.rowType(row))) {
      asked.push_back(constraints.rowMap()->getGlobalElement(row));
      places.push_back(row);
    }
  const auto forces = lookUp(*constraints.rowMap()->getComm(), known, asked);
  HARMOS_REQUIRE(rest_.size() + places.size() == static_cast<std::size_t>(size) || !isKept_,
                 "rows that stay are as many as they were");
  auto result = Teuchos::rcp(new MultiVector(constraints.rowMap(), 1));
  const auto lambda = result->getLocalViewHost(Tpetra::Access::ReadWrite);
  for (std::size_t k = 0; k < places.size(); ++k)
    lambda(static_cast<std::size_t>(places[k]), 0) =
        forces[k].value_or(0.0) / constraints.rowScale(places[k]);
  std::size_t next = 0;
  for (int row = 0; row < size && isKept_; ++row)
    if (feti::isUnconditional(constraints.rowType(row)))
      lambda(static_cast<std::size_t>(row), 0) = rest_[next++];
  return result;
}

namespace {

// Rows that stay, by numbers that do not depend on how many others there are.
Teuchos::RCP<const Map> mapOfRest(const feti::Constraints& constraints) {
  const long long others = constraints.inequalities() + constraints.limited();
  std::vector<GlobalOrdinal> numbers;
  const auto size = static_cast<int>(localSize(*constraints.rowMap()));
  for (int row = 0; row < size; ++row)
    if (feti::isUnconditional(constraints.rowType(row)))
      numbers.push_back(constraints.rowMap()->getGlobalElement(row) - others);
  const auto total = static_cast<Tpetra::global_size_t>(constraints.dualDimension() - others);
  return Teuchos::rcp(
      new Map(total, Teuchos::arrayViewFromVector(numbers), 0, constraints.rowMap()->getComm()));
}

} // namespace

void CarriedForces::exchange(qp::StateArchive<MultiVector>& archive, const std::string& name,
                             const feti::Constraints& constraints) {
  archive.number(name + " are there", isKept_);
  constexpr std::size_t width = 10; // effect, node, side, forces along and across, normal
  std::vector<double> points;
  if (!archive.isReading()) {
    for (const auto& [key, force] : ofPoints_) {
      for (const double value : {static_cast<double>(std::get<0>(key)), static_cast<double>(std::get<1>(key)),
                                 static_cast<double>(std::get<2>(key)), force.along})
        points.push_back(value);
      points.insert(points.end(), force.across.begin(), force.across.end());
      points.insert(points.end(), force.normal.begin(), force.normal.end());
    }
    points = gatherAll(*constraints.rowMap()->getComm(), points);
  }
  archive.numbers(name + " of points", points);
  MultiVector rest(mapOfRest(constraints), 1);
  if (!archive.isReading() && isKept_) {
    const auto view = rest.getLocalViewHost(Tpetra::Access::OverwriteAll);
    std::copy(rest_.begin(), rest_.end(), view.data());
  }
  archive.vector(name + " of the rest", rest);
  if (!archive.isReading())
    return;
  ofPoints_.clear(); // those of other ranks do no harm
  for (std::size_t k = 0; k + width <= points.size(); k += width)
    ofPoints_[Key{static_cast<std::size_t>(points[k]), static_cast<long long>(points[k + 1]),
                  static_cast<int>(points[k + 2])}] = {points[k + 3],
                                                       {points[k + 4], points[k + 5], points[k + 6]},
                                                       {points[k + 7], points[k + 8], points[k + 9]}};
  const auto view = rest.getLocalViewHost(Tpetra::Access::ReadOnly);
  rest_.assign(view.data(), view.data() + view.extent(0));
}

} // namespace Harmos::run
