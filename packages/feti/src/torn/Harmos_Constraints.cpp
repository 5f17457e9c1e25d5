// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Constraints.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_DofCopies.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_GivenRows.hpp"
#include "Harmos_GluingRows.hpp"
#include "Harmos_Log.hpp"
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
#include <unordered_map>
#include <utility>

namespace Harmos::feti {
namespace {

using Details::Copy;
using Details::CopyTerm;
using Details::DofCopies;
using Details::dofText;
using Details::GivenRow;
using Details::GluingRows;
using Details::RowEntry;

// The rest of a row on its way to its owner.
struct RowHead {
  long long row;
  double bound;
  double scale;
  double compliance;
  int type;
  double limit = 0.0;
  long long disc = -1;
  double coefficient = 0.0;
  long long normal = -1;  // row that the limit follows
  double softness = -1.0; // −1: none
  int status = 0;
};

using Importer = Tpetra::Import<LocalOrdinal, GlobalOrdinal, Node>;

std::vector<double> brought(const MultiVector& rows, const Importer& importer) {
  MultiVector target(importer.getTargetMap(), 1);
  target.doImport(rows, importer, Tpetra::INSERT);
  const auto view = target.getLocalViewHost(Tpetra::Access::ReadOnly);
  return {view.data(), view.data() + view.extent(0)};
}

Copy lowestOf(Copy lowest, const std::vector<CopyTerm>& terms) {
  for (const CopyTerm& term : terms)
    if (term.copy.subdomain < lowest.subdomain)
      lowest = term.copy;
  return lowest;
}

struct RowBuilder {
  explicit RowBuilder(std::size_t ranks) : entries(ranks), held(ranks), leans(ranks), heads(ranks) {}

  // A row belongs to the rank of its lowest subdomain.
  void add(const RowHead& head, const std::vector<CopyTerm>& terms) {
    add(head, terms, lowestOf(terms.front().copy, terms).rank);
  }

  // @param acts false: a row without entries.
  void add(const RowHead& head, const std::vector<CopyTerm>& terms, int owner, bool acts = true) {
    if (acts)
      for (const CopyTerm& term : terms)
        entries[static_cast<std::size_t>(term.copy.rank)].push_back(
            {head.row, term.value, term.copy.place, term.copy.local, owner});
    heads[static_cast<std::size_t>(owner)].push_back(head);
  }

  // What a given row is at prescribed dofs, scaled like the rest of it.
  void addHeld(long long row, const std::vector<CopyTerm>& terms) {
    for (const CopyTerm& term : terms)
      held[static_cast<std::size_t>(term.copy.rank)].push_back(
          {row, term.value, term.copy.place, term.copy.local, 0});
  }

  std::vector<std::vector<RowEntry>> entries, held;
  std::vector<std::vector<Details::Lean>> leans;
  double rounding2 = 0.0; // of scaled bounds, squares
  std::vector<std::vector<RowHead>> heads;
};

// Rows that follow from the copies alone.
// @return the first row of each dof.
std::map<long long, long long> addGluingAndDirichlet(const DofCopies::Table& table, DirichletForm form,
                                                     long long row, RowBuilder& builder) {
  std::map<long long, long long> first;
  // Values that come from a function of the position differ by rounding from copy to copy.
  double largest = 0.0;
  for (const auto& item : table)
    for (const Copy& copy : item.second)
      largest = std::max(largest, copy.fixed != 0 ? std::abs(copy.value) : 0.0);
  const double same = 1e-12 * largest;
  std::vector<CopyTerm> terms;
  for (const auto& item : table) {
    const std::vector<Copy>& copies = item.second;
    const Copy* fixed = nullptr;
    for (const Copy& copy : copies) {
      if (copy.fixed == 0)
        continue;
      if (fixed != nullptr && std::abs(copy.value - fixed->value) > same)
        throw InputError(dofText(copy) + " is fixed to " + scientific(copy.value) + " here and to " +
                             scientific(fixed->value) + " in subdomain " + std::to_string(fixed->subdomain),
                         {{"dof", std::to_string(copy.dof)}});
      fixed = fixed == nullptr ? &copy : fixed;
    }
    if (fixed != nullptr && form == DirichletForm::Dual) {
      for (const Copy& copy : copies) {
        const double scale = std::sqrt(copy.weight);
        builder.add({row++, scale * fixed->value, scale, 0.0, static_cast<int>(RowType::Dirichlet)},
                    {{copy, scale}});
      }
      continue;
    }
    first.emplace_hint(first.end(), item.first, row);
    const GluingRows rows(copies);
    for (std::size_t k = 0; k < rows.count(); ++k) {
      terms.clear();
      for (std::size_t i = 0; i <= k + 1; ++i)
        terms.push_back({copies[i], rows.value(k, i)});
      // Physical: the distance of this copy from the mean of those before it.
      builder.add({row++, 0.0, rows.scale(k), 0.0, static_cast<int>(RowType::Gluing)}, terms);
    }
  }
  return first;
}

long long countGluingAndDirichlet(const DofCopies::Table& table, DirichletForm form) {
  long long count = 0;
  for (const auto& item : table) {
    const bool fixed =
        std::any_of(item.second.begin(), item.second.end(), [](const Copy& copy) { return copy.fixed != 0; });
    const auto copies = static_cast<long long>(item.second.size());
    count += fixed && form == DirichletForm::Dual ? copies : copies - 1;
  }
  return count;
}

RowType typeOf(ConstraintRow::Kind kind) {
  return kind == ConstraintRow::Kind::Inequality ? RowType::Inequality
         : kind == ConstraintRow::Kind::Limited  ? RowType::Limited
                                                 : RowType::Equality;
}

// Given rows of a rank on their way to B.
struct GivenRows {
  std::vector<GivenRow> rows;  // those that are not taken
  std::vector<double> lengths; // squares
  std::vector<int> owners;
};

// Rows of a disc have one length, or it would be none, and one owner.
GivenRows given(const std::vector<ConstraintRow>& rows, const std::vector<char>& isTaken,
                const DofCopies::Answers& answers, DirichletForm form, double unit, double softness) {
  GivenRows result;
  std::vector<Copy> lowest(rows.size());
  for (std::size_t r = 0; r < rows.size(); ++r) {
    GivenRow& row = result.rows.emplace_back();
    result.lengths.push_back(0.0);
    if (isTaken[r])
      continue;
    row = Details::givenRow(rows[r], answers, form, softness);
    result.lengths.back() = row.norm2 + row.compliance * unit;
    lowest[r] = lowestOf((row.terms.empty() ? row.held : row.terms).front().copy, row.terms);
  }
  for (const auto& [first, second] : Details::discsOf(rows)) {
    result.lengths[first] = result.lengths[second] = 0.5 * (result.lengths[first] + result.lengths[second]);
    for (std::size_t r : {first, second})
      for (const std::vector<CopyTerm>* part : {&result.rows[r].terms, &result.rows[r].held})
        lowest[first] = lowestOf(lowest[first], *part);
    lowest[second] = lowest[first];
  }
  // A limit that follows a force needs it at hand.
  const std::vector<std::array<std::size_t, 2>> followers = Details::followersOf(rows);
  for (const auto& [row, normal] : followers)
    if (lowest[row].subdomain < lowest[normal].subdomain)
      lowest[normal] = lowest[row];
  for (const auto& [row, normal] : followers)
    lowest[row] = lowest[normal];
  for (const Copy& copy : lowest)
    result.owners.push_back(copy.rank);
  return result;
}

// Without what it is given by itself; −1: none.
double softnessOf(const ConstraintRow& row, const GivenRow& given) {
  return row.softness ? std::max(0.0, *row.softness - (given.compliance - row.compliance)) : -1.0;
}

// @param unit the stiffness of a weight of one, by which compliances are scaled; 0 without weights.
// @return the factors of their multipliers.
std::vector<Details::MultiplierTerm> addGiven(const std::vector<ConstraintRow>& rows,
                                              const std::vector<char>& isTaken,
                                              const std::vector<long long>& numbers, const DofCopies& dofs,
                                              const DofCopies::Answers& answers, GivenRows given,
                                              RowBuilder& builder) {
  std::vector<Details::MultiplierTerm> multipliers;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (isTaken[r])
      continue;
    const ConstraintRow& row = rows[r];
    GivenRow& part = given.rows[r];
    const double scale = 1.0 / std::sqrt(given.lengths[r]);
    for (std::vector<CopyTerm>* terms : {&part.terms, &part.held})
      for (CopyTerm& term : *terms)
        term.value *= scale;
    const long long number = numbers[r];
    multipliers.push_back({static_cast<int>(r), number, scale});
    builder.add({number, scale * part.bound, scale, part.compliance * scale * scale,
                 static_cast<int>(typeOf(row.kind)), row.limit / scale, row.disc, row.coefficient, row.normal,
                 softnessOf(row, part) * scale * scale, static_cast<int>(row.status)},
                part.terms, given.owners[r], !part.isIdle);
    builder.addHeld(number, part.held);
    for (const ConstraintRow::Term& term : row.terms)
      if (answers.isUnited(term.dof)) {
        const long long name = answers.name.at(term.dof);
        builder.leans[dofs.home(name)].push_back({name, term.dof, number, scale * term.coefficient});
      }
    builder.rounding2 += std::pow(scale * row.rounding, 2);
  }
  return multipliers;
}

// Places of the rows of each disc among those that are sorted.
std::vector<std::array<int, 2>> pairsOf(const std::vector<RowHead>& heads) {
  std::map<long long, std::vector<int>> places;
  for (std::size_t r = 0; r < heads.size(); ++r)
    if (heads[r].disc >= 0)
      places[heads[r].disc].push_back(static_cast<int>(r));
  std::vector<std::array<int, 2>> pairs;
  for (const auto& item : places) {
    HARMOS_REQUIRE(item.second.size() == 2, "a disc has not two rows on the rank that owns them");
    pairs.push_back({item.second[0], item.second[1]});
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

// By local rows; of a disc its first row. Inequalities have the lowest numbers, and keep them.
std::vector<Constraints::Follower> followersAmong(const std::vector<RowHead>& heads,
                                                  const std::vector<std::array<int, 2>>& discs) {
  std::vector<Constraints::Follower> result;
  std::unordered_map<long long, int> placeOf;
  for (std::size_t r = 0; r < heads.size(); ++r)
    if (heads[r].type == static_cast<int>(RowType::Inequality))
      placeOf.emplace(heads[r].row, static_cast<int>(r));
  std::size_t disc = 0;
  for (std::size_t r = 0; r < heads.size(); ++r) {
    const bool isFirst = disc < discs.size() && discs[disc][0] == static_cast<int>(r);
    const RowHead& head = heads[r];
    if (head.normal >= 0 && head.softness < 0.0 && (head.disc < 0 || isFirst)) {
      const int normal = placeOf.at(head.normal);
      if (heads[static_cast<std::size_t>(normal)].softness >= 0.0)
        throw InputError("a limit follows the force of inequality " + std::to_string(head.normal) +
                             ", which is soft and can pull; give softness to both rows or to none",
                         {{"row", std::to_string(head.normal)}});
      // λ = scale · that of the scaled row
      const double factor = head.coefficient * heads[static_cast<std::size_t>(normal)].scale / head.scale;
      result.push_back({static_cast<int>(r), isFirst ? static_cast<int>(disc) : -1, normal, factor});
    }
    disc += isFirst ? 1 : 0;
  }
  return result;
}

std::vector<RowHead> joined(const std::vector<std::vector<RowHead>>& parts) {
  std::vector<RowHead> all;
  for (const std::vector<RowHead>& part : parts)
    all.insert(all.end(), part.begin(), part.end());
  return all;
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

} // namespace

Constraints::Constraints(const SubdomainSystem& system, const std::vector<ConstraintRow>& rows,
                         RowWeights weights)
    : Constraints(system, rows, weights != RowWeights::None,
                  weights == RowWeights::None ? Details::Weights() : Details::stiffnessWeights(system)) {}

Constraints::Constraints(const SubdomainSystem& system, const std::vector<ConstraintRow>& rows,
                         bool hasWeights, Details::Weights weights)
    : system_(&system), weights_(std::move(weights)), hasWeights_(hasWeights) {
  const Teuchos::Comm<int>& comm = *system.comm();
  const auto ranks = static_cast<std::size_t>(comm.getSize());

  const Details::GivenCounts counts = Details::countGiven(comm, rows);
  inequalities_ = counts.inequalities;
  limited_ = counts.limited;
  const long long givenRows = inequalities_ + limited_ + counts.equalities;
  const double softness = limited_ > 0 ? Details::meanSoftness(system) : 0.0;

  DofCopies dofs(system, rows, weights_.ofDofs);
  const std::vector<char> isTaken = dofs.unite(rows, hasWeights_);
  const std::vector<long long> numbers = Details::numbersOfGiven(comm, rows, isTaken, counts);
  const long long taken =
      globalSum(comm, static_cast<long long>(std::count(isTaken.begin(), isTaken.end(), 1)));
  const long long fromCopies = countGluingAndDirichlet(dofs.here(), system.dirichletForm());
  const long long firstRow = givenRows - taken + exclusiveScan(comm, fromCopies);
  dualDimension_ = givenRows - taken + globalSum(comm, fromCopies);

  const DofCopies::Answers answers = dofs.ask(rows);
  RowBuilder builder(ranks);
  std::map<long long, long long> gluing; // the first row of each dof
  std::vector<Details::MultiplierTerm> multipliers;
  GivenRows parts;
  agree(comm, [&] {
    gluing = addGluingAndDirichlet(dofs.here(), system.dirichletForm(), firstRow, builder);
    parts = given(rows, isTaken, answers, system.dirichletForm(), weights_.unit, softness);
    multipliers = addGiven(rows, isTaken, numbers, dofs, answers, parts, builder);
    keepGiven(rows, isTaken, parts.rows);
  });
  if (taken > 0)
    for (const std::vector<Details::MultiplierTerm>& part :
         exchangeItems(comm, multipliersOfUnions(dofs, gluing, exchangeItems(comm, builder.leans))))
      multipliers.insert(multipliers.end(), part.begin(), part.end());
  const std::vector<std::vector<RowEntry>> entries = exchangeItems(comm, builder.entries);

  std::vector<RowHead> heads = joined(exchangeItems(comm, builder.heads));
  sortRuns(heads, [](const RowHead& a, const RowHead& b) { return a.row < b.row; });
  Teuchos::Array<GlobalOrdinal> owned;
  for (const RowHead& head : heads) {
    owned.push_back(static_cast<GlobalOrdinal>(head.row));
    types_.push_back(static_cast<RowType>(head.type));
    scales_.push_back(head.scale);
    bounds_.push_back(head.bound);
    compliances_.push_back(head.compliance);
    limits_.push_back(head.limit);
    softness_.push_back(head.softness);
    statuses_.push_back(static_cast<ConstraintRow::Status>(head.status));
    isInterval_.push_back(rowType(static_cast<int>(types_.size()) - 1) == RowType::Limited && head.disc < 0 &&
                                  !(head.softness >= 0.0)
                              ? 1
                              : 0);
  }
  pairs_ = pairsOf(heads);
  findSoft(comm);
  if (limited_ > 0) {
    agree(comm, [&] { followers_ = followersAmong(heads, discs_); });
    followerCount_ = globalSum(comm, static_cast<long long>(followers_.size()));
  }

  std::vector<std::pair<long long, int>> overlap; // row, owner
  for (const std::vector<RowEntry>& part : entries)
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
  entries_ = bySubdomain(entries, localRow, system.size());

  const auto total = static_cast<Tpetra::global_size_t>(dualDimension_);
  rowMap_ = Teuchos::rcp(new Map(total, owned(), 0, system.comm()));
  overlapMap_ = Teuchos::rcp(
      new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(), touched(), 0, system.comm()));
  import_ = Teuchos::rcp(new Tpetra::Import<LocalOrdinal, GlobalOrdinal, Node>(rowMap_, overlapMap_));
  keepFullRows(exchangeItems(comm, builder.held));
  std::map<long long, int> ofGiven;
  for (const Details::MultiplierTerm& term : multipliers)
    ofGiven[term.row] = 0;
  const Teuchos::Array<GlobalOrdinal> given = numbered(ofGiven);
  givenMap_ = Teuchos::rcp(
      new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(), given(), 0, system.comm()));
  givenImport_ = Teuchos::rcp(new Importer(rowMap_, givenMap_));
  multipliers_.resize(rows.size());
  for (const Details::MultiplierTerm& term : multipliers)
    multipliers_[static_cast<std::size_t>(term.place)].push_back({ofGiven.at(term.row), term.factor});
  boundRounding_ = std::sqrt(globalSum(comm, builder.rounding2));
  hasCompliance_ =
      globalMax(comm, std::any_of(compliances_.begin(), compliances_.end(), [](double c) { return c > 0.0; })
                          ? 1LL
                          : 0LL) > 0;
}

// And discs that are none of them.
void Constraints::findSoft(const Teuchos::Comm<int>& comm) {
  long long any = 0, limited = 0;
  openCount_ = globalSum(comm, static_cast<long long>(std::count(statuses_.begin(), statuses_.end(),
                                                                 ConstraintRow::Status::Open)));
  for (std::size_t r = 0; r < types_.size(); ++r)
    if (isSoft(static_cast<int>(r))) {
      any = 1;
      limited += types_[r] == RowType::Limited ? 1 : 0;
    }
  hasSoft_ = globalMax(comm, any) > 0;
  softLimited_ = hasSoft_ ? globalSum(comm, limited) : 0;
  for (const std::array<int, 2>& pair : pairs_)
    if (!isSoft(pair[0]))
      discs_.push_back(pair);
  discCount_ = limited_ > 0 ? globalSum(comm, static_cast<long long>(discs_.size())) : 0;
}

void Constraints::keepFullRows(const std::vector<std::vector<RowEntry>>& held) {
  std::map<long long, int> localRow;
  for (const std::vector<RowEntry>& part : held)
    for (const RowEntry& entry : part)
      localRow[entry.row] = 0;
  const Teuchos::Array<GlobalOrdinal> touched = numbered(localRow);
  heldEntries_ = bySubdomain(held, localRow, system_->size());
  heldMap_ = Teuchos::rcp(
      new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(), touched(), 0, system_->comm()));
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

std::vector<double> Constraints::limits(const MultiVector& lambda) const {
  std::vector<double> result = limits_;
  if (followers_.empty())
    return result;
  const auto forces = lambda.getLocalViewHost(Tpetra::Access::ReadOnly);
  for (const Follower& follower : followers_) {
    const double limit =
        follower.factor * std::max(0.0, forces(static_cast<std::size_t>(follower.normal), 0));
    result[static_cast<std::size_t>(follower.row)] = limit;
    if (follower.disc >= 0)
      result[static_cast<std::size_t>(discs_[static_cast<std::size_t>(follower.disc)][1])] = limit;
  }
  return result;
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
  std::vector<double> overlap(localSize(*overlapMap_), 0.0);
  for (int i = 0; i < system_->size(); ++i)
    addB(i, u[static_cast<std::size_t>(i)].data(), overlap.data());
  fromOverlap(overlap, y);
}

void Constraints::residual(const TornVector& u, const MultiVector& lambda, MultiVector& y) const {
  applyB(u, y);
  const auto force = lambda.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto view = y.getLocalViewHost(Tpetra::Access::ReadWrite);
  for (std::size_t r = 0; r < view.extent(0); ++r)
    view(r, 0) -= bounds_[r] + compliances_[r] * force(r, 0);
  if (hasSoft_)
    for (std::size_t r = 0; r < view.extent(0); ++r)
      view(r, 0) -= giving(static_cast<int>(r), force(r, 0));
}

void Constraints::fromOverlap(const std::vector<double>& overlap, MultiVector& y) const {
  MultiVector vector(overlapMap_, 1);
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
  for (const std::vector<MultiplierTerm>& terms : multipliers_) {
    double& sum = result.emplace_back(0.0);
    for (const MultiplierTerm& term : terms)
      sum += term.factor * values[static_cast<std::size_t>(term.place)];
  }
  return result;
}

// Of scaled rows: a multiplier's factor is the scale, and a residual's is its inverse.
std::vector<double> Constraints::atGiven(MultiVector& scaled) const {
  {
    const auto view = scaled.getLocalViewHost(Tpetra::Access::ReadWrite);
    for (std::size_t r = 0; r < view.extent(0); ++r)
      view(r, 0) /= scales_[r] * scales_[r];
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
