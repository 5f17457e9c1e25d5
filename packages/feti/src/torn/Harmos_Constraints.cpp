// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Constraints.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_DofCopies.hpp"
#include "Harmos_Exchange.hpp"
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
#include <utility>

namespace Harmos::feti {
namespace {

using Details::Copy;
using Details::DofCopies;
using Details::GluingRows;
using RowEntry = Details::RowEntry;

// The rest of a row on its way to its owner.
struct RowHead {
  long long row;
  double bound;
  double scale;
  double compliance;
  int type;
};

using Importer = Tpetra::Import<LocalOrdinal, GlobalOrdinal, Node>;

std::vector<double> brought(const MultiVector& rows, const Importer& importer) {
  MultiVector target(importer.getTargetMap(), 1);
  target.doImport(rows, importer, Tpetra::INSERT);
  const auto view = target.getLocalViewHost(Tpetra::Access::ReadOnly);
  return {view.data(), view.data() + view.extent(0)};
}

struct RowBuilder {
  explicit RowBuilder(std::size_t ranks) : entries(ranks), held(ranks), leans(ranks), heads(ranks) {}

  struct Term {
    Copy copy;
    double value;
  };

  // @param acts false: a row without entries.
  void add(const RowHead& head, const std::vector<Term>& terms, bool acts = true) {
    const Term* lowest = &terms.front();
    for (const Term& term : terms)
      if (term.copy.subdomain < lowest->copy.subdomain)
        lowest = &term;
    const int owner = lowest->copy.rank;
    if (acts)
      for (const Term& term : terms)
        entries[static_cast<std::size_t>(term.copy.rank)].push_back(
            {head.row, term.value, term.copy.place, term.copy.local, owner});
    heads[static_cast<std::size_t>(owner)].push_back(head);
  }

  // What a given row is at prescribed dofs, scaled like the rest of it.
  void addHeld(long long row, const std::vector<Term>& terms) {
    for (const Term& term : terms)
      held[static_cast<std::size_t>(term.copy.rank)].push_back(
          {row, term.value, term.copy.place, term.copy.local, 0});
  }

  std::vector<std::vector<RowEntry>> entries, held;
  std::vector<std::vector<Details::Lean>> leans;
  double rounding2 = 0.0; // of scaled bounds, squares
  std::vector<std::vector<RowHead>> heads;
};

std::string dofText(const Copy& copy) {
  return "dof " + std::to_string(copy.dof) + " (subdomain " + std::to_string(copy.subdomain) + ")";
}

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
  std::vector<RowBuilder::Term> terms;
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

// A row of prescribed values alone has to hold already: no force can change it. What is left of its bound.
double requireMet(const ConstraintRow& row, const std::map<long long, double>& coefficients,
                  const DofCopies::Table& copies) {
  double value = 0.0, size = std::abs(row.bound);
  for (const auto& [dof, coefficient] : coefficients)
    for (const Copy& copy : copies.at(dof))
      if (copy.fixed != 0) {
        value += coefficient * copy.value;
        size = std::max(size, std::abs(coefficient * copy.value));
        break;
      }
  const bool inequality = row.kind == ConstraintRow::Kind::Inequality;
  const double excess = inequality ? value - row.bound : std::abs(value - row.bound);
  // Prescribed values and gaps come from decks and coordinates.
  if (excess > std::max(1e-9 * size, row.rounding))
    throw InputError("prescribed displacements contradict " +
                         std::string(inequality ? "a contact or an obstacle" : "a tie") +
                         ": constraint row " + std::to_string(row.number) + " (" +
                         dofText(copies.at(coefficients.begin()->first).front()) +
                         ") holds prescribed values alone, and they violate it by " + scientific(excess) +
                         "; free a component there or move the obstacle",
                     {{"row", std::to_string(row.number)}});
  return -excess;
}

// Of the rows that are left, in the order given: inequalities first.
std::vector<long long> globalNumbers(const Teuchos::Comm<int>& comm, const std::vector<ConstraintRow>& rows,
                                     const std::vector<char>& isTaken, long long inequalities,
                                     long long equalities) {
  std::vector<long long> numbers;
  long long taken = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    numbers.push_back(rows[r].kind == ConstraintRow::Kind::Inequality ? rows[r].number
                                                                      : inequalities + rows[r].number);
    taken += isTaken[r];
  }
  if (globalSum(comm, taken) == 0)
    return numbers;
  // Those with lower numbers are counted where ranges of numbers meet.
  const long long width = equalities / comm.getSize() + 1;
  std::vector<std::vector<long long>> questions(static_cast<std::size_t>(comm.getSize()));
  std::vector<std::vector<std::size_t>> asking(questions.size());
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (rows[r].kind == ConstraintRow::Kind::Equality && !isTaken[r]) {
      const auto rank = static_cast<std::size_t>(rows[r].number / width);
      questions[rank].push_back(rows[r].number);
      asking[rank].push_back(r);
    }
  std::vector<std::vector<long long>> answers = exchangeItems(comm, questions);
  std::map<long long, long long> order;
  for (const std::vector<long long>& part : answers)
    for (long long number : part)
      order[number] = 0;
  long long next = inequalities + exclusiveScan(comm, static_cast<long long>(order.size()));
  for (auto& item : order)
    item.second = next++;
  for (std::vector<long long>& part : answers)
    for (long long& number : part)
      number = order.at(number);
  answers = exchangeItems(comm, answers);
  for (std::size_t rank = 0; rank < answers.size(); ++rank)
    for (std::size_t k = 0; k < answers[rank].size(); ++k)
      numbers[asking[rank][k]] = answers[rank][k];
  return numbers;
}

// By name: a dof named twice counts once, with the sum, and so do dofs that are united; of what cancels
// there, rounding errors are left.
std::map<long long, double> coefficientsOf(const ConstraintRow& row, const DofCopies::Answers& answers) {
  constexpr double rounding = 1e-12; // as where contact rows are compared
  std::map<long long, double> sums, sizes;
  for (const ConstraintRow::Term& term : row.terms) {
    if (answers.of(term.dof) == nullptr)
      throw InputError("constraint row " + std::to_string(row.number) + " names dof " +
                           std::to_string(term.dof) + ", which is not an interface dof of any subdomain",
                       {{"dof", std::to_string(term.dof)}});
    sums[answers.name.at(term.dof)] += term.coefficient;
    sizes[answers.name.at(term.dof)] += std::abs(term.coefficient);
  }
  for (const ConstraintRow::Term& term : row.terms)
    if (const long long name = answers.name.at(term.dof);
        answers.isUnited(term.dof) && std::abs(sums[name]) <= rounding * sizes[name])
      sums[name] = 0.0;
  return sums;
}

bool namesUnited(const ConstraintRow& row, const DofCopies::Answers& answers) {
  return std::any_of(row.terms.begin(), row.terms.end(), [&](const ConstraintRow::Term& term) {
    return term.coefficient != 0.0 && answers.isUnited(term.dof);
  });
}

// A row between dofs that others hold together has to hold already, as between two bodies that touch where
// both are tied to a third one.
void requireJoined(const ConstraintRow& row, const Copy& copy) {
  const bool inequality = row.kind == ConstraintRow::Kind::Inequality;
  const double excess = inequality ? -row.bound : std::abs(row.bound);
  if (excess > row.rounding)
    throw InputError("ties contradict " + std::string(inequality ? "a contact" : "a tie") +
                         ": constraint row " + std::to_string(row.number) + " (" + dofText(copy) +
                         ") is between dofs that are tied to each other, and they violate it by " +
                         scientific(excess) + "; leave the place out of one of them",
                     {{"row", std::to_string(row.number)}});
}

// A given row by the copies of its dofs, not yet scaled.
struct GivenRow {
  std::vector<RowBuilder::Term> terms, held; ///< with unknowns; at prescribed values
  double norm2 = 0.0;                        ///< bD⁻¹bᵀ
  double bound = 0.0;
  bool hasUnknown = false;
  bool isIdle = false; ///< no force of its own moves anything
};

// A prescribed value is no unknown: its share goes to the bound (equality rows may be added to any row), or
// the force of the row would move the trivial equation. A row of prescribed values alone stays as it is.
GivenRow byCopies(const ConstraintRow& row, const std::map<long long, double>& coefficients,
                  const DofCopies::Table& copies) {
  GivenRow result;
  result.bound = row.bound;
  const auto fixedCopyOf = [&](long long dof) -> const Copy* {
    const std::vector<Copy>& all = copies.at(dof);
    const auto found = std::find_if(all.begin(), all.end(), [](const Copy& copy) { return copy.fixed != 0; });
    return found == all.end() ? nullptr : &*found;
  };
  result.hasUnknown = std::any_of(coefficients.begin(), coefficients.end(), [&](const auto& term) {
    return term.second != 0.0 && fixedCopyOf(term.first) == nullptr;
  });
  for (const auto& [dof, coefficient] : coefficients) {
    const std::vector<Copy>& all = copies.at(dof);
    double whole = 0.0;
    for (const Copy& copy : all)
      whole += copy.weight;
    const Copy* fixed = fixedCopyOf(dof);
    for (const Copy& copy : all) {
      const double share = coefficient * copy.weight / whole;
      if (fixed != nullptr)
        result.held.push_back({copy, share});
      if (fixed != nullptr && result.hasUnknown)
        continue;
      result.terms.push_back({copy, share});
      result.norm2 += share * share / copy.weight;
    }
    if (fixed != nullptr && result.hasUnknown)
      result.bound -= coefficient * fixed->value;
  }
  return result;
}

// Σ coefficient · value over prescribed dofs.
double ofPrescribed(const std::map<long long, double>& coefficients, const DofCopies::Table& copies) {
  double sum = 0.0;
  for (const auto& [dof, coefficient] : coefficients)
    for (const Copy& copy : copies.at(dof))
      if (copy.fixed != 0) {
        sum += coefficient * copy.value;
        break;
      }
  return sum;
}

// A row that no force can change has to hold already; one that gives way bears a force all the same, which is
// known.
void settle(GivenRow& given, const ConstraintRow& row, const std::map<long long, double>& coefficients,
            const DofCopies::Answers& answers, DirichletForm form) {
  const DofCopies::Table& copies = answers.copies;
  const bool isJoined = given.norm2 == 0.0 && namesUnited(row, answers);
  if (!(given.norm2 > 0.0 || isJoined) || !std::isfinite(given.norm2) || !std::isfinite(given.bound))
    throw InputError("constraint row " + std::to_string(row.number) +
                     " is zero or not finite; check its coefficients and its gap");
  if (!(row.compliance >= 0.0) || !std::isfinite(row.compliance))
    throw InputError("constraint row " + std::to_string(row.number) + " has a compliance of " +
                         scientific(row.compliance) + "; it has to be zero or more, and finite",
                     {{"row", std::to_string(row.number)}});
  if (given.hasUnknown)
    return;
  if (row.compliance > 0.0) {
    given.isIdle = true;
    given.bound -= ofPrescribed(coefficients, copies);
    given.norm2 = isJoined ? 1.0 : given.norm2;
  } else if (isJoined) {
    requireJoined(row, copies.at(coefficients.begin()->first).front());
    given.isIdle = true;
    given.bound = 0.0;
    given.norm2 = 1.0;
  } else {
    const double left = requireMet(row, coefficients, copies);
    // Beside the rows of its dofs' prescribed values it would be a dependent one, which the preconditioner
    // could not tell from those.
    const bool inequality = row.kind == ConstraintRow::Kind::Inequality;
    given.isIdle = inequality && form == DirichletForm::Dual;
    given.bound = given.isIdle ? std::max(0.0, left) : given.bound;
  }
}

// @param unit the stiffness of a weight of one, by which compliances are scaled; 0 without weights.
// @return the factors of their multipliers.
std::vector<Details::MultiplierTerm> addGiven(const std::vector<ConstraintRow>& rows,
                                              const std::vector<char>& isTaken,
                                              const std::vector<long long>& numbers, const DofCopies& dofs,
                                              const DofCopies::Answers& answers, DirichletForm form,
                                              double unit, RowBuilder& builder) {
  std::vector<Details::MultiplierTerm> multipliers;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (isTaken[r])
      continue;
    const ConstraintRow& row = rows[r];
    const std::map<long long, double> coefficients = coefficientsOf(row, answers);
    GivenRow given = byCopies(row, coefficients, answers.copies);
    settle(given, row, coefficients, answers, form);
    const double scale = 1.0 / std::sqrt(given.norm2 + row.compliance * unit);
    for (std::vector<RowBuilder::Term>* part : {&given.terms, &given.held})
      for (RowBuilder::Term& term : *part)
        term.value *= scale;
    const long long number = numbers[r];
    multipliers.push_back({static_cast<int>(r), number, scale});
    const RowType type =
        row.kind == ConstraintRow::Kind::Inequality ? RowType::Inequality : RowType::Equality;
    builder.add({number, scale * given.bound, scale, row.compliance * scale * scale, static_cast<int>(type)},
                given.terms, !given.isIdle);
    builder.addHeld(number, given.held);
    for (const ConstraintRow::Term& term : row.terms)
      if (answers.isUnited(term.dof)) {
        const long long name = answers.name.at(term.dof);
        builder.leans[dofs.home(name)].push_back({name, term.dof, number, scale * term.coefficient});
      }
    builder.rounding2 += std::pow(scale * row.rounding, 2);
  }
  return multipliers;
}

void checkNumbers(const Teuchos::Comm<int>& comm, const std::vector<ConstraintRow>& rows,
                  ConstraintRow::Kind kind, long long count) {
  long long most = -1, least = 0;
  for (const ConstraintRow& row : rows)
    if (row.kind == kind) {
      most = std::max(most, row.number);
      least = std::min(least, row.number);
    }
  if (globalMax(comm, most) + 1 > count || globalMin(comm, least) < 0)
    throw InputError("constraint rows of one kind must be numbered 0, 1, ... without gaps over all ranks");
}

} // namespace

Constraints::Constraints(const SubdomainSystem& system, const std::vector<ConstraintRow>& rows,
                         RowWeights weights)
    : Constraints(system, rows, weights != RowWeights::None,
                  weights == RowWeights::None ? Details::Weights() : Details::stiffnessWeights(system)) {}

Constraints::Constraints(const SubdomainSystem& system, const std::vector<ConstraintRow>& rows,
                         bool hasWeights, Details::Weights weights)
    : system_(system), weights_(std::move(weights)), hasWeights_(hasWeights) {
  const Teuchos::Comm<int>& comm = *system.comm();
  const auto ranks = static_cast<std::size_t>(comm.getSize());

  long long mine[2] = {0, 0};
  for (const ConstraintRow& row : rows)
    ++mine[row.kind == ConstraintRow::Kind::Inequality ? 0 : 1];
  inequalities_ = globalSum(comm, mine[0]);
  const long long equalities = globalSum(comm, mine[1]);
  checkNumbers(comm, rows, ConstraintRow::Kind::Inequality, inequalities_);
  checkNumbers(comm, rows, ConstraintRow::Kind::Equality, equalities);

  DofCopies dofs(system, rows, weights_.ofDofs);
  const std::vector<char> isTaken = dofs.unite(rows, hasWeights_);
  const std::vector<long long> numbers = globalNumbers(comm, rows, isTaken, inequalities_, equalities);
  const long long taken =
      globalSum(comm, static_cast<long long>(std::count(isTaken.begin(), isTaken.end(), 1)));
  const long long fromCopies = countGluingAndDirichlet(dofs.here(), system.dirichletForm());
  const long long firstRow = inequalities_ + equalities - taken + exclusiveScan(comm, fromCopies);
  dualDimension_ = inequalities_ + equalities - taken + globalSum(comm, fromCopies);

  const DofCopies::Answers answers = dofs.ask(rows);
  RowBuilder builder(ranks);
  std::map<long long, long long> gluing; // the first row of each dof
  std::vector<Details::MultiplierTerm> multipliers;
  agree(comm, [&] {
    gluing = addGluingAndDirichlet(dofs.here(), system.dirichletForm(), firstRow, builder);
    multipliers =
        addGiven(rows, isTaken, numbers, dofs, answers, system.dirichletForm(), weights_.unit, builder);
  });
  if (taken > 0)
    for (const std::vector<Details::MultiplierTerm>& part :
         exchangeItems(comm, multipliersOfUnions(dofs, gluing, exchangeItems(comm, builder.leans))))
      multipliers.insert(multipliers.end(), part.begin(), part.end());
  const std::vector<std::vector<RowEntry>> entries = exchangeItems(comm, builder.entries);
  const std::vector<std::vector<RowHead>> headParts = exchangeItems(comm, builder.heads);

  std::vector<RowHead> heads;
  for (const std::vector<RowHead>& part : headParts)
    heads.insert(heads.end(), part.begin(), part.end());
  sortRuns(heads, [](const RowHead& a, const RowHead& b) { return a.row < b.row; });
  Teuchos::Array<GlobalOrdinal> owned;
  for (const RowHead& head : heads) {
    owned.push_back(static_cast<GlobalOrdinal>(head.row));
    types_.push_back(static_cast<RowType>(head.type));
    scales_.push_back(head.scale);
    bounds_.push_back(head.bound);
    compliances_.push_back(head.compliance);
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
  Teuchos::Array<GlobalOrdinal> given;
  for (auto& [row, place] : ofGiven) {
    place = static_cast<int>(given.size());
    given.push_back(static_cast<GlobalOrdinal>(row));
  }
  givenMap_ = Teuchos::rcp(
      new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(), given(), 0, system.comm()));
  multipliers_.resize(rows.size());
  for (const Details::MultiplierTerm& term : multipliers)
    multipliers_[static_cast<std::size_t>(term.place)].push_back({ofGiven.at(term.row), term.factor});
  boundRounding_ = std::sqrt(globalSum(comm, builder.rounding2));
  hasCompliance_ =
      globalMax(comm, std::any_of(compliances_.begin(), compliances_.end(), [](double c) { return c > 0.0; })
                          ? 1LL
                          : 0LL) > 0;
}

void Constraints::keepFullRows(const std::vector<std::vector<RowEntry>>& held) {
  std::map<long long, int> localRow;
  for (const std::vector<RowEntry>& part : held)
    for (const RowEntry& entry : part)
      localRow[entry.row] = 0;
  Teuchos::Array<GlobalOrdinal> touched;
  for (auto& [row, place] : localRow) {
    place = static_cast<int>(touched.size());
    touched.push_back(static_cast<GlobalOrdinal>(row));
  }
  heldEntries_ = bySubdomain(held, localRow, system_.size());
  heldMap_ = Teuchos::rcp(
      new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(), touched(), 0, system_.comm()));
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

void Constraints::setBounds(const std::vector<ConstraintRow>& rows) {
  const Constraints changed(system_, rows, hasWeights_, weights_);
  agree(*system_.comm(), [&] {
    if (changed.types_ != types_ || changed.entries_ != entries_ || changed.compliances_ != compliances_ ||
        !changed.rowMap_->isLocallyFitted(*rowMap_))
      throw InputError(
          "constraint rows are given new bounds, but their number, kinds, dofs coefficients or compliances "
          "have "
          "changed too (with weights, a bound other than zero of a row that glues two dofs is such a "
          "change); new "
          "constraints are needed");
  });
  bounds_ = changed.bounds_;
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
  for (int i = 0; i < system_.size(); ++i)
    addB(i, u[static_cast<std::size_t>(i)].data(), overlap.data());
  fromOverlap(overlap, y);
}

void Constraints::residual(const TornVector& u, const MultiVector& lambda, MultiVector& y) const {
  applyB(u, y);
  const auto force = lambda.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto view = y.getLocalViewHost(Tpetra::Access::ReadWrite);
  for (std::size_t r = 0; r < view.extent(0); ++r)
    view(r, 0) -= bounds_[r] + compliances_[r] * force(r, 0);
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

// An exchange of its own, for what is asked once a solution.
std::vector<double> Constraints::givenMultipliers(const MultiVector& lambda) const {
  const std::vector<double> values = brought(lambda, Importer(rowMap_, givenMap_));
  std::vector<double> result;
  for (const std::vector<MultiplierTerm>& terms : multipliers_) {
    double& sum = result.emplace_back(0.0);
    for (const MultiplierTerm& term : terms)
      sum += term.factor * values[static_cast<std::size_t>(term.place)];
  }
  return result;
}

std::vector<std::vector<double>> Constraints::heldForces(const MultiVector& lambda) const {
  const std::vector<double> multipliers = brought(lambda, Importer(rowMap_, heldMap_));
  std::vector<std::vector<double>> result;
  for (int i = 0; i < system_.size(); ++i) {
    std::map<int, double> atDof;
    for (const Entry& entry : heldEntries_[static_cast<std::size_t>(i)])
      atDof[entry.dof] += entry.value * multipliers[static_cast<std::size_t>(entry.row)];
    std::vector<double>& forces = result.emplace_back();
    for (const FixedDof& fixed : system_.subdomain(i).fixed)
      forces.push_back(atDof.count(fixed.dof) > 0 ? atDof[fixed.dof] : 0.0);
  }
  return result;
}

} // namespace Harmos::feti
