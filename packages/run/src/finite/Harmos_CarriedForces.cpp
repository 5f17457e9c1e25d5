// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CarriedForces.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Rendezvous.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <unordered_map>

namespace Harmos::run {

void CarriedForces::clear() {
  isKept_ = false;
  ofPoints_.clear();
  rest_.clear();
}

// Rows of this rank's points, by their numbers in B.
std::vector<std::pair<long long, CarriedForces::Key>>
CarriedForces::rowsOf(const feti::Constraints& constraints, const scene::ContactSetup& contact) const {
  std::unordered_map<const scene::Effect*, std::size_t> places;
  for (std::size_t k = 0; k < scene_->effects.size(); ++k)
    places[scene_->effects[k].get()] = k;
  std::vector<std::pair<long long, Key>> rows;
  const auto keyOf = [&](std::size_t point, int direction) {
    return Key{places.at(contact.effects[point]), contact.points[point].node, contact.points[point].side,
               direction};
  };
  for (std::size_t k = 0; k < contact.points.size(); ++k)
    rows.emplace_back(contact.points[k].number, keyOf(k, 0));
  for (const contact::SlipPoint& slip : contact.slips)
    for (std::size_t t = 0; t < slip.tangents.size(); ++t)
      rows.emplace_back(constraints.inequalities() + slip.firstRow + static_cast<long long>(t),
                        keyOf(slip.point, 1 + static_cast<int>(t)));
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
  const auto rows = rowsOf(constraints, contact);
  std::vector<long long> asked;
  for (const auto& row : rows)
    asked.push_back(row.first);
  const auto forces = lookUp(*constraints.rowMap()->getComm(), known, asked);
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (forces[k].value_or(0.0) != 0.0)
      ofPoints_[rows[k].second] = *forces[k];
}

Teuchos::RCP<MultiVector> CarriedForces::on(const feti::Constraints& constraints,
                                            const scene::ContactSetup& contact) const {
  std::vector<std::pair<long long, double>> known;
  for (const auto& [row, key] : rowsOf(constraints, contact))
    if (const auto found = ofPoints_.find(key); found != ofPoints_.end())
      known.emplace_back(row, found->second);
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
  constexpr std::size_t width = 5; // effect, node, side, direction, force
  std::vector<double> points;
  if (!archive.isReading()) {
    for (const auto& [key, force] : ofPoints_)
      for (const double value :
           {static_cast<double>(std::get<0>(key)), static_cast<double>(std::get<1>(key)),
            static_cast<double>(std::get<2>(key)), static_cast<double>(std::get<3>(key)), force})
        points.push_back(value);
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
                  static_cast<int>(points[k + 2]), static_cast<int>(points[k + 3])}] = points[k + 4];
  const auto view = rest.getLocalViewHost(Tpetra::Access::ReadOnly);
  rest_.assign(view.data(), view.data() + view.extent(0));
}

} // namespace Harmos::run
