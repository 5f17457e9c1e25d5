// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Constraints.hpp"

#include "Harmos_BuiltRows.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_SortRuns.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <tuple>
#include <utility>

namespace Harmos::feti {
namespace {

using Details::BuiltRows;
using Details::RowEntry;

using Importer = Tpetra::Import<LocalOrdinal, GlobalOrdinal, Node>;

std::vector<double> brought(const MultiVector& rows, const Importer& importer) {
  MultiVector target(importer.getTargetMap(), 1);
  target.doImport(rows, importer, Tpetra::INSERT);
  const auto view = target.getLocalViewHost(Tpetra::Access::ReadOnly);
  return {view.data(), view.data() + view.extent(0)};
}

// Gives rows their places, by rising numbers. @return these.
Teuchos::Array<GlobalOrdinal> numbered(std::map<long long, int>& places) {
  Teuchos::Array<GlobalOrdinal> rows;
  for (auto& [row, place] : places) {
    place = static_cast<int>(rows.size());
    rows.push_back(static_cast<GlobalOrdinal>(row));
  }
  return rows;
}

Teuchos::RCP<const Map> mapOf(const Teuchos::Array<GlobalOrdinal>& rows, const SubdomainSystem& system) {
  return Teuchos::rcp(
      new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(), rows(), 0, system.comm()));
}

} // namespace

Constraints::Constraints(const SubdomainSystem& system, const std::vector<ConstraintRow>& rows,
                         RowWeights weights)
    : Constraints(system, rows, weights != RowWeights::None,
                  weights == RowWeights::None ? Details::Weights() : Details::stiffnessWeights(system)) {}

Constraints::Constraints(const SubdomainSystem& system, const std::vector<ConstraintRow>& rows,
                         bool hasWeights, const Details::Weights& weights)
    : Constraints(system, rows, hasWeights, weights, Details::buildRows(system, rows, hasWeights, weights)) {}

Constraints::Constraints(const SubdomainSystem& system, const std::vector<ConstraintRow>& rows,
                         bool hasWeights, const Details::Weights& weights, const BuiltRows& built)
    : RowConditions(*system.comm(), built.owned, built.counts.inequalities, built.counts.limited,
                    built.rounding2),
      system_(&system),
      weights_(weights),
      hasWeights_(hasWeights) {
  keepRows(built);
  enterFrames();
  keepFullRows(built.held);
  keepGiven(rows, built);
  keepMultipliers(built.multipliers);
}

void Constraints::keepRows(const BuiltRows& built) {
  Teuchos::Array<GlobalOrdinal> owned;
  for (const RowCondition& row : built.owned)
    owned.push_back(static_cast<GlobalOrdinal>(row.number));
  std::vector<std::pair<long long, int>> overlap; // row, owner
  for (const std::vector<RowEntry>& part : built.entries)
    for (const RowEntry& entry : part)
      if (overlap.empty() || overlap.back().first != entry.row)
        overlap.emplace_back(entry.row, entry.owner);
  sortRuns(overlap, std::less<>());
  overlap.erase(std::unique(overlap.begin(), overlap.end()), overlap.end());
  Teuchos::Array<GlobalOrdinal> touched;
  std::map<long long, int> localRow;
  for (const auto& [row, owner] : overlap) {
    localRow.emplace_hint(localRow.end(), row, static_cast<int>(touched.size()));
    touched.push_back(static_cast<GlobalOrdinal>(row));
    overlapOwner_.push_back(owner);
  }
  entries_ = bySubdomain(built.entries, localRow, system_->size());
  const auto total = static_cast<Tpetra::global_size_t>(built.dualDimension);
  rowMap_ = Teuchos::rcp(new Map(total, owned(), 0, system_->comm()));
  import_ = Teuchos::rcp(new Importer(rowMap_, mapOf(touched, *system_)));
}

// B_i ← B_i T.
void Constraints::enterFrames() {
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Frame* frame = system_->frame(static_cast<int>(i));
    if (frame == nullptr)
      continue;
    std::vector<Entry> turned;
    const int components = frame->components();
    for (auto begin = entries_[i].begin(); begin != entries_[i].end();) {
      const int row = begin->row, node = begin->dof / components;
      std::array<double, 3> before{};
      for (; begin != entries_[i].end() && begin->row == row && begin->dof / components == node; ++begin)
        before[static_cast<std::size_t>(begin->dof % components)] += begin->value;
      for (int b = 0; b < components; ++b) {
        double value = 0.0;
        for (int a = 0; a < components; ++a)
          value += before[static_cast<std::size_t>(a)] *
                   (*frame)(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
        turned.push_back({row, node * components + b, value});
      }
    }
    entries_[i] = std::move(turned);
  }
}

void Constraints::keepFullRows(const std::vector<std::vector<RowEntry>>& held) {
  std::map<long long, int> localRow;
  for (const std::vector<RowEntry>& part : held)
    for (const RowEntry& entry : part)
      localRow[entry.row] = 0;
  const Teuchos::Array<GlobalOrdinal> touched = numbered(localRow);
  heldEntries_ = bySubdomain(held, localRow, system_->size());
  heldMap_ = mapOf(touched, *system_);
}

void Constraints::keepMultipliers(const std::vector<Details::MultiplierTerm>& terms) {
  std::map<long long, int> places;
  for (const Details::MultiplierTerm& term : terms)
    places[term.row] = 0;
  givenImport_ = Teuchos::rcp(new Importer(rowMap_, mapOf(numbered(places), *system_)));
  for (const Details::MultiplierTerm& term : terms)
    standings_[static_cast<std::size_t>(term.place)].multiplier.push_back({places.at(term.row), term.factor});
}

// Sorted by row.
std::vector<std::vector<Constraints::Entry>>
Constraints::bySubdomain(const std::vector<std::vector<RowEntry>>& entries,
                         const std::map<long long, int>& localRow, int subdomains) {
  std::vector<std::vector<Entry>> result(static_cast<std::size_t>(subdomains));
  for (const std::vector<RowEntry>& part : entries)
    for (const RowEntry& entry : part)
      result[static_cast<std::size_t>(entry.place)].push_back(
          {localRow.at(entry.row), entry.local, entry.value});
  for (std::vector<Entry>& list : result)
    std::sort(list.begin(), list.end(),
              [](const Entry& a, const Entry& b) { return std::tie(a.row, a.dof) < std::tie(b.row, b.dof); });
  return result;
}

Teuchos::RCP<const Map> Constraints::overlapMap() const {
  return import_->getTargetMap();
}

long long Constraints::dualDimension() const {
  return static_cast<long long>(rowMap_->getGlobalNumElements());
}

void Constraints::addBt(int subdomain, const double* overlap, double* t) const {
  for (const Entry& entry : entries(subdomain))
    t[entry.dof] += entry.value * overlap[entry.row];
}

void Constraints::addB(int subdomain, const double* u, double* overlap) const {
  for (const Entry& entry : entries(subdomain))
    overlap[entry.row] += entry.value * u[entry.dof];
}

void Constraints::applyB(const TornVector& u, MultiVector& y) const {
  std::vector<double> overlap(localSize(*overlapMap()), 0.0);
  for (int i = 0; i < system_->size(); ++i)
    addB(i, u[static_cast<std::size_t>(i)].data(), overlap.data());
  fromOverlap(overlap, y);
}

void Constraints::residual(const TornVector& u, const MultiVector& lambda, MultiVector& y) const {
  applyB(u, y);
  const auto force = lambda.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto view = y.getLocalViewHost(Tpetra::Access::ReadWrite);
  for (std::size_t r = 0; r < view.extent(0); ++r)
    view(r, 0) -= bound(static_cast<int>(r)) + compliance(static_cast<int>(r)) * force(r, 0);
  if (hasSoft())
    for (std::size_t r = 0; r < view.extent(0); ++r)
      view(r, 0) -= giving(static_cast<int>(r), force(r, 0));
}

void Constraints::fromOverlap(const std::vector<double>& overlap, MultiVector& y) const {
  MultiVector vector(overlapMap(), 1);
  {
    const auto view = vector.getLocalViewHost(Tpetra::Access::OverwriteAll);
    std::copy(overlap.begin(), overlap.end(), view.data());
  }
  y.putScalar(0.0);
  y.doExport(vector, *import_, Tpetra::ADD);
}

std::vector<double> Constraints::toOverlap(const MultiVector& lambda) const {
  return brought(lambda, *import_);
}

std::vector<double> Constraints::givenMultipliers(const MultiVector& lambda) const {
  const std::vector<double> values = brought(lambda, *givenImport_);
  std::vector<double> result;
  for (const Given& given : standings_) {
    double& sum = result.emplace_back(0.0);
    for (const MultiplierTerm& term : given.multiplier)
      sum += term.factor * values[static_cast<std::size_t>(term.place)];
  }
  return result;
}

// Of scaled rows: a multiplier's factor is the scale, and a residual's is its inverse.
std::vector<double> Constraints::atGiven(MultiVector& scaled) const {
  {
    const auto view = scaled.getLocalViewHost(Tpetra::Access::ReadWrite);
    for (std::size_t r = 0; r < view.extent(0); ++r)
      view(r, 0) /= rowScale(static_cast<int>(r)) * rowScale(static_cast<int>(r));
  }
  return givenMultipliers(scaled);
}

std::vector<double> Constraints::givenProducts(const TornVector& v) const {
  MultiVector image(rowMap_, 1);
  applyB(v, image);
  return atGiven(image);
}

std::vector<double> Constraints::givenResiduals(const TornVector& u, const MultiVector& lambda) const {
  MultiVector left(rowMap_, 1);
  residual(u, lambda, left);
  return atGiven(left);
}

std::vector<std::vector<double>> Constraints::heldForces(const MultiVector& lambda) const {
  const std::vector<double> multipliers = brought(lambda, Importer(rowMap_, heldMap_));
  std::vector<std::vector<double>> result;
  for (int i = 0; i < system_->size(); ++i) {
    std::map<int, double> atDof;
    for (const Entry& entry : heldEntries_[static_cast<std::size_t>(i)])
      atDof[entry.dof] += entry.value * multipliers[static_cast<std::size_t>(entry.row)];
    std::vector<double>& forces = result.emplace_back();
    for (const FixedDof& fixed : system_->subdomain(i).fixed)
      forces.push_back(atDof.count(fixed.dof) > 0 ? atDof[fixed.dof] : 0.0);
  }
  return result;
}

} // namespace Harmos::feti
