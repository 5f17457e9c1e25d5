// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BuiltRows.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_SortRuns.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace Harmos::feti::Details {
namespace {

Copy lowestOf(Copy lowest, const std::vector<CopyTerm>& terms) {
  for (const CopyTerm& term : terms)
    if (term.copy.subdomain < lowest.subdomain)
      lowest = term.copy;
  return lowest;
}

struct RowBuilder {
  explicit RowBuilder(std::size_t ranks) : entries(ranks), held(ranks), leans(ranks), heads(ranks) {}

  // A row belongs to the rank of its lowest subdomain.
  void add(const RowCondition& head, const std::vector<CopyTerm>& terms) {
    add(head, terms, lowestOf(terms.front().copy, terms).rank);
  }

  // @param acts false: a row without entries.
  void add(const RowCondition& head, const std::vector<CopyTerm>& terms, int owner, bool acts = true) {
    if (acts)
      for (const CopyTerm& term : terms)
        entries[static_cast<std::size_t>(term.copy.rank)].push_back(
            {head.number, term.value, term.copy.place, term.copy.local, owner});
    heads[static_cast<std::size_t>(owner)].push_back(head);
  }

  // What a given row is at prescribed dofs, scaled like the rest of it.
  void addHeld(long long row, const std::vector<CopyTerm>& terms) {
    for (const CopyTerm& term : terms)
      held[static_cast<std::size_t>(term.copy.rank)].push_back(
          {row, term.value, term.copy.place, term.copy.local, 0});
  }

  std::vector<std::vector<RowEntry>> entries, held;
  std::vector<std::vector<Lean>> leans;
  double rounding2 = 0.0; // of scaled bounds, squares
  std::vector<std::vector<RowCondition>> heads;
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
        builder.add({row++, scale * fixed->value, scale, 0.0, RowType::Dirichlet}, {{copy, scale}});
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
      builder.add({row++, 0.0, rows.scale(k), 0.0, RowType::Gluing}, terms);
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
    row = givenRow(rows[r], answers, form, softness);
    result.lengths.back() = row.norm2 + row.compliance * unit;
    lowest[r] = lowestOf((row.terms.empty() ? row.held : row.terms).front().copy, row.terms);
  }
  for (const auto& [first, second] : discsOf(rows)) {
    result.lengths[first] = result.lengths[second] = 0.5 * (result.lengths[first] + result.lengths[second]);
    for (std::size_t r : {first, second})
      for (const std::vector<CopyTerm>* part : {&result.rows[r].terms, &result.rows[r].held})
        lowest[first] = lowestOf(lowest[first], *part);
    lowest[second] = lowest[first];
  }
  // A limit that follows a force needs it at hand.
  const std::vector<std::array<std::size_t, 2>> followers = followersOf(rows);
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
std::vector<MultiplierTerm> addGiven(const std::vector<ConstraintRow>& rows, const std::vector<char>& isTaken,
                                     const std::vector<long long>& numbers, const DofCopies& dofs,
                                     const DofCopies::Answers& answers, GivenRows given,
                                     RowBuilder& builder) {
  std::vector<MultiplierTerm> multipliers;
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
    builder.add({number, scale * part.bound, scale, part.compliance * scale * scale, typeOf(row.kind),
                 row.limit / scale, row.disc, row.coefficient, row.normal,
                 softnessOf(row, part) * scale * scale, row.status},
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

std::vector<RowCondition> joined(const std::vector<std::vector<RowCondition>>& parts) {
  std::vector<RowCondition> all;
  for (const std::vector<RowCondition>& part : parts)
    all.insert(all.end(), part.begin(), part.end());
  return all;
}

} // namespace

BuiltRows buildRows(const SubdomainSystem& system, const std::vector<ConstraintRow>& rows, bool hasWeights,
                    const Weights& weights) {
  const Teuchos::Comm<int>& comm = *system.comm();
  BuiltRows built;
  built.counts = countGiven(comm, rows);
  const long long givenRows = built.counts.inequalities + built.counts.limited + built.counts.equalities;
  const double softness = built.counts.limited > 0 ? meanSoftness(system) : 0.0;

  DofCopies dofs(system, rows, weights.ofDofs);
  built.isTaken = dofs.unite(rows, hasWeights);
  const std::vector<long long> numbers = numbersOfGiven(comm, rows, built.isTaken, built.counts);
  const long long taken =
      globalSum(comm, static_cast<long long>(std::count(built.isTaken.begin(), built.isTaken.end(), 1)));
  const long long fromCopies = countGluingAndDirichlet(dofs.here(), system.dirichletForm());
  const long long firstRow = givenRows - taken + exclusiveScan(comm, fromCopies);
  built.dualDimension = givenRows - taken + globalSum(comm, fromCopies);

  const DofCopies::Answers answers = dofs.ask(rows);
  RowBuilder builder(static_cast<std::size_t>(comm.getSize()));
  std::map<long long, long long> gluing; // the first row of each dof
  agree(comm, [&] {
    gluing = addGluingAndDirichlet(dofs.here(), system.dirichletForm(), firstRow, builder);
    GivenRows parts = given(rows, built.isTaken, answers, system.dirichletForm(), weights.unit, softness);
    built.parts = parts.rows;
    built.multipliers = addGiven(rows, built.isTaken, numbers, dofs, answers, std::move(parts), builder);
  });
  if (taken > 0)
    for (const std::vector<MultiplierTerm>& part :
         exchangeItems(comm, multipliersOfUnions(dofs, gluing, exchangeItems(comm, builder.leans))))
      built.multipliers.insert(built.multipliers.end(), part.begin(), part.end());
  built.entries = exchangeItems(comm, builder.entries);
  built.owned = joined(exchangeItems(comm, builder.heads));
  sortRuns(built.owned, [](const RowCondition& a, const RowCondition& b) { return a.number < b.number; });
  built.held = exchangeItems(comm, builder.held);
  built.rounding2 = builder.rounding2;
  return built;
}

} // namespace Harmos::feti::Details
