// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Constraints.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace Harmos::feti {
namespace {

// A copy of a dof, as the rendezvous rank of the dof sees it.
struct Copy {
  long long dof;
  long long subdomain;
  double value; // of the Dirichlet condition
  int local;    // dof in the subdomain
  int place;    // subdomain among those of its rank
  int rank;
  int fixed;
};

using RowEntry = Details::RowEntry;

// The rest of a row on its way to its owner.
struct RowHead {
  long long row;
  double bound;
  double scale;
  int type;
};

// Where the copies of a dof meet: equal ranges of dof numbers.
class Rendezvous {
 public:
  Rendezvous(long long least, long long most, int ranks) : least_(least) {
    width_ = std::max(1LL, (most - least) / ranks + 1);
  }
  std::size_t operator()(long long dof) const { return static_cast<std::size_t>((dof - least_) / width_); }

 private:
  long long least_;
  long long width_;
};

using Importer = Tpetra::Import<LocalOrdinal, GlobalOrdinal, Node>;

std::vector<double> brought(const MultiVector& rows, const Importer& importer) {
  MultiVector target(importer.getTargetMap(), 1);
  target.doImport(rows, importer, Tpetra::INSERT);
  const auto view = target.getLocalViewHost(Tpetra::Access::ReadOnly);
  return {view.data(), view.data() + view.extent(0)};
}

struct RowBuilder {
  explicit RowBuilder(std::size_t ranks) : entries(ranks), held(ranks), heads(ranks) {}

  struct Term {
    Copy copy;
    double value;
  };

  // @param acts false: a row without entries.
  void add(long long row, RowType type, const std::vector<Term>& terms, double bound, double scale,
           bool acts = true) {
    const Term* lowest = &terms.front();
    for (const Term& term : terms)
      if (term.copy.subdomain < lowest->copy.subdomain)
        lowest = &term;
    const int owner = lowest->copy.rank;
    if (acts)
      for (const Term& term : terms)
        entries[static_cast<std::size_t>(term.copy.rank)].push_back(
            {row, term.value, term.copy.place, term.copy.local, owner});
    heads[static_cast<std::size_t>(owner)].push_back({row, bound, scale, static_cast<int>(type)});
  }

  // What a given row is at prescribed dofs, scaled like the rest of it.
  void addHeld(long long row, const std::vector<Term>& terms) {
    for (const Term& term : terms)
      held[static_cast<std::size_t>(term.copy.rank)].push_back(
          {row, term.value, term.copy.place, term.copy.local, 0});
  }

  std::vector<std::vector<RowEntry>> entries, held;
  double rounding2 = 0.0; // of scaled bounds, squares
  std::vector<std::vector<RowHead>> heads;
};

using CopyTable = std::map<long long, std::vector<Copy>>;

// Every interface dof of this rank goes to its rendezvous rank.
CopyTable meet(const SubdomainSystem& system, const Rendezvous& rendezvous) {
  const Teuchos::Comm<int>& comm = *system.comm();
  std::vector<std::vector<Copy>> sends(static_cast<std::size_t>(comm.getSize()));
  for (int i = 0; i < system.size(); ++i) {
    const Subdomain& s = system.subdomain(i);
    std::map<int, const FixedDof*> fixed;
    for (const FixedDof& f : s.fixed)
      fixed[f.dof] = &f;
    for (std::size_t k = 0; k < s.numbers.size(); ++k) {
      const int local = (*s.interface)[k];
      const long long dof = s.numbers[k];
      const auto found = fixed.find(local);
      sends[rendezvous(dof)].push_back({dof, s.number, found != fixed.end() ? found->second->value : 0.0,
                                        local, i, comm.getRank(), found != fixed.end() ? 1 : 0});
    }
  }
  CopyTable table;
  for (const std::vector<Copy>& part : exchangeItems(comm, sends))
    for (const Copy& copy : part)
      table[copy.dof].push_back(copy);
  for (auto& item : table)
    std::sort(item.second.begin(), item.second.end(), [](const Copy& a, const Copy& b) {
      return std::tie(a.subdomain, a.local) < std::tie(b.subdomain, b.local);
    });
  return table;
}

std::string dofText(const Copy& copy) {
  return "dof " + std::to_string(copy.dof) + " (subdomain " + std::to_string(copy.subdomain) + ")";
}

// Rows that follow from the copies alone.
void addGluingAndDirichlet(const CopyTable& table, DirichletForm form, long long& row, RowBuilder& builder) {
  // Values that come from a function of the position differ by rounding from copy to copy.
  double largest = 0.0;
  for (const auto& item : table)
    for (const Copy& copy : item.second)
      largest = std::max(largest, copy.fixed != 0 ? std::abs(copy.value) : 0.0);
  const double same = 1e-12 * largest;
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
      for (const Copy& copy : copies)
        builder.add(row++, RowType::Dirichlet, {{copy, 1.0}}, fixed->value, 1.0);
      continue;
    }
    for (std::size_t k = 1; k < copies.size(); ++k) {
      const double number = static_cast<double>(k);
      const double length = std::sqrt(number * (number + 1.0));
      std::vector<RowBuilder::Term> terms;
      for (std::size_t i = 0; i < k; ++i)
        terms.push_back({copies[i], 1.0 / length});
      terms.push_back({copies[k], -number / length});
      // Physical: the distance of this copy from the mean of those before it.
      builder.add(row++, RowType::Gluing, terms, 0.0, number / length);
    }
  }
}

long long countGluingAndDirichlet(const CopyTable& table, DirichletForm form) {
  long long count = 0;
  for (const auto& item : table) {
    const bool fixed =
        std::any_of(item.second.begin(), item.second.end(), [](const Copy& copy) { return copy.fixed != 0; });
    const auto copies = static_cast<long long>(item.second.size());
    count += fixed && form == DirichletForm::Dual ? copies : copies - 1;
  }
  return count;
}

// The copies of the dofs in this rank's given rows, asked of the rendezvous ranks.
CopyTable lookUp(const Teuchos::Comm<int>& comm, const CopyTable& table, const Rendezvous& rendezvous,
                 const std::vector<ConstraintRow>& rows) {
  std::vector<std::vector<long long>> questions(static_cast<std::size_t>(comm.getSize()));
  for (const ConstraintRow& row : rows)
    for (const ConstraintRow::Term& term : row.terms)
      questions[rendezvous(term.dof)].push_back(term.dof);
  for (std::vector<long long>& part : questions) {
    std::sort(part.begin(), part.end());
    part.erase(std::unique(part.begin(), part.end()), part.end());
  }
  const std::vector<std::vector<long long>> asked = exchangeItems(comm, questions);
  std::vector<std::vector<Copy>> answers(asked.size());
  for (std::size_t r = 0; r < asked.size(); ++r)
    for (long long dof : asked[r]) {
      const auto found = table.find(dof);
      if (found != table.end())
        answers[r].insert(answers[r].end(), found->second.begin(), found->second.end());
    }
  CopyTable result;
  for (const std::vector<Copy>& part : exchangeItems(comm, answers))
    for (const Copy& copy : part)
      result[copy.dof].push_back(copy);
  return result;
}

// A row of prescribed values alone has to hold already: no force can change it. What is left of its bound.
double requireMet(const ConstraintRow& row, const std::map<long long, double>& coefficients,
                  const CopyTable& copies) {
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

long long globalNumber(const ConstraintRow& row, long long inequalities) {
  return row.kind == ConstraintRow::Kind::Inequality ? row.number : inequalities + row.number;
}

void addGiven(const std::vector<ConstraintRow>& rows, const CopyTable& copies, DirichletForm form,
              long long inequalities, RowBuilder& builder) {
  for (const ConstraintRow& row : rows) {
    std::vector<RowBuilder::Term> terms, held;
    double norm2 = 0.0;
    std::map<long long, double> coefficients; // a dof named twice counts once, with the sum
    for (const ConstraintRow::Term& term : row.terms)
      coefficients[term.dof] += term.coefficient;
    // A prescribed value is no unknown: its share goes to the bound (equality rows may be added to any row),
    // or the force of the row would move the trivial equation. A row of prescribed values alone stays as it
    // is.
    double bound = row.bound;
    const auto isFixed = [&](long long dof) {
      const auto found = copies.find(dof);
      return found != copies.end() && std::any_of(found->second.begin(), found->second.end(),
                                                  [](const Copy& copy) { return copy.fixed != 0; });
    };
    const bool hasUnknown = std::any_of(coefficients.begin(), coefficients.end(), [&](const auto& term) {
      return term.second != 0.0 && !isFixed(term.first);
    });
    for (const auto& [dof, coefficient] : coefficients) {
      const auto found = copies.find(dof);
      if (found == copies.end())
        throw InputError("constraint row " + std::to_string(row.number) + " names dof " +
                             std::to_string(dof) + ", which is not an interface dof of any subdomain",
                         {{"dof", std::to_string(dof)}});
      const double share = coefficient / static_cast<double>(found->second.size());
      if (isFixed(dof))
        for (const Copy& copy : found->second)
          held.push_back({copy, share});
      if (hasUnknown && isFixed(dof)) {
        const auto fixed = std::find_if(found->second.begin(), found->second.end(),
                                        [](const Copy& copy) { return copy.fixed != 0; });
        bound -= coefficient * fixed->value;
        continue;
      }
      for (const Copy& copy : found->second) {
        terms.push_back({copy, share});
        norm2 += share * share;
      }
    }
    if (!(norm2 > 0.0) || !std::isfinite(norm2) || !std::isfinite(bound))
      throw InputError("constraint row " + std::to_string(row.number) +
                       " is zero or not finite; check its coefficients and its gap");
    const bool inequality = row.kind == ConstraintRow::Kind::Inequality;
    bool isIdle = false;
    if (!hasUnknown) {
      const double left = requireMet(row, coefficients, copies);
      // Beside the rows of its dofs' prescribed values it would be a dependent one, which the preconditioner
      // could not tell from those.
      isIdle = inequality && form == DirichletForm::Dual;
      bound = isIdle ? std::max(0.0, left) : bound;
    }
    const double scale = 1.0 / std::sqrt(norm2);
    for (std::vector<RowBuilder::Term>* part : {&terms, &held})
      for (RowBuilder::Term& term : *part)
        term.value *= scale;
    const long long number = globalNumber(row, inequalities);
    builder.add(number, inequality ? RowType::Inequality : RowType::Equality, terms, scale * bound, scale,
                !isIdle);
    builder.addHeld(number, held);
    builder.rounding2 += std::pow(scale * row.rounding, 2);
  }
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

Constraints::Constraints(const SubdomainSystem& system, const std::vector<ConstraintRow>& rows)
    : system_(system) {
  const Teuchos::Comm<int>& comm = *system.comm();
  const auto ranks = static_cast<std::size_t>(comm.getSize());

  long long least = std::numeric_limits<long long>::max(), most = std::numeric_limits<long long>::min();
  for (int i = 0; i < system.size(); ++i)
    for (long long dof : system.subdomain(i).numbers) {
      least = std::min(least, dof);
      most = std::max(most, dof);
    }
  least = globalMin(comm, least);
  most = globalMax(comm, most);
  if (most < least) // no subdomain has an interface
    least = most = 0;
  agree(comm, [&] {
    for (const ConstraintRow& row : rows)
      for (const ConstraintRow::Term& term : row.terms)
        if (term.dof < least || term.dof > most)
          throw InputError("constraint row " + std::to_string(row.number) + " names dof " +
                           std::to_string(term.dof) + ", which no subdomain has");
  });
  const Rendezvous rendezvous(least, most, comm.getSize());
  const CopyTable table = meet(system, rendezvous);

  long long mine[2] = {0, 0};
  for (const ConstraintRow& row : rows)
    ++mine[row.kind == ConstraintRow::Kind::Inequality ? 0 : 1];
  inequalities_ = globalSum(comm, mine[0]);
  const long long equalities = globalSum(comm, mine[1]);
  checkNumbers(comm, rows, ConstraintRow::Kind::Inequality, inequalities_);
  checkNumbers(comm, rows, ConstraintRow::Kind::Equality, equalities);
  const long long fromCopies = countGluingAndDirichlet(table, system.dirichletForm());
  long long nextRow = inequalities_ + equalities + exclusiveScan(comm, fromCopies);
  dualDimension_ = inequalities_ + equalities + globalSum(comm, fromCopies);

  const CopyTable copies = lookUp(comm, table, rendezvous, rows);
  RowBuilder builder(ranks);
  agree(comm, [&] {
    addGluingAndDirichlet(table, system.dirichletForm(), nextRow, builder);
    addGiven(rows, copies, system.dirichletForm(), inequalities_, builder);
  });
  const std::vector<std::vector<RowEntry>> entries = exchangeItems(comm, builder.entries);
  const std::vector<std::vector<RowHead>> headParts = exchangeItems(comm, builder.heads);

  std::vector<RowHead> heads;
  for (const std::vector<RowHead>& part : headParts)
    heads.insert(heads.end(), part.begin(), part.end());
  std::sort(heads.begin(), heads.end(), [](const RowHead& a, const RowHead& b) { return a.row < b.row; });
  Teuchos::Array<GlobalOrdinal> owned;
  for (const RowHead& head : heads) {
    owned.push_back(static_cast<GlobalOrdinal>(head.row));
    types_.push_back(static_cast<RowType>(head.type));
    scales_.push_back(head.scale);
    bounds_.push_back(head.bound);
  }

  std::map<long long, int> overlap; // row → owner
  for (const std::vector<RowEntry>& part : entries)
    for (const RowEntry& entry : part)
      overlap[entry.row] = entry.owner;
  Teuchos::Array<GlobalOrdinal> touched;
  std::map<long long, int> localRow;
  for (const auto& [row, owner] : overlap) {
    localRow[row] = static_cast<int>(touched.size());
    touched.push_back(static_cast<GlobalOrdinal>(row));
    overlapOwner_.push_back(owner);
  }
  entries_ = bySubdomain(entries, localRow, system.size());

  const auto total = static_cast<Tpetra::global_size_t>(dualDimension_);
  rowMap_ = Teuchos::rcp(new Map(total, owned(), 0, system.comm()));
  overlapMap_ = Teuchos::rcp(
      new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(), touched(), 0, system.comm()));
  import_ = Teuchos::rcp(new Tpetra::Import<LocalOrdinal, GlobalOrdinal, Node>(rowMap_, overlapMap_));
  keepFullRows(exchangeItems(comm, builder.held), rows);
  boundRounding_ = std::sqrt(globalSum(comm, builder.rounding2));
}

void Constraints::keepFullRows(const std::vector<std::vector<RowEntry>>& held,
                               const std::vector<ConstraintRow>& rows) {
  std::map<long long, int> localRow;
  for (const std::vector<RowEntry>& part : held)
    for (const RowEntry& entry : part)
      localRow[entry.row] = 0;
  Teuchos::Array<GlobalOrdinal> touched, given;
  for (auto& [row, place] : localRow) {
    place = static_cast<int>(touched.size());
    touched.push_back(static_cast<GlobalOrdinal>(row));
  }
  heldEntries_ = bySubdomain(held, localRow, system_.size());
  for (const ConstraintRow& row : rows)
    given.push_back(static_cast<GlobalOrdinal>(globalNumber(row, inequalities_)));
  const auto unknown = Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid();
  heldMap_ = Teuchos::rcp(new Map(unknown, touched(), 0, system_.comm()));
  givenMap_ = Teuchos::rcp(new Map(unknown, given(), 0, system_.comm()));
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
  const Constraints changed(system_, rows);
  agree(*system_.comm(), [&] {
    if (changed.types_ != types_ || changed.entries_ != entries_ ||
        !changed.rowMap_->isLocallyFitted(*rowMap_))
      throw InputError(
          "constraint rows are given new bounds, but their number, kinds, dofs or coefficients have "
          "changed too; new constraints are needed");
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
  MultiVector physical(lambda, Teuchos::Copy);
  {
    const auto view = physical.getLocalViewHost(Tpetra::Access::ReadWrite);
    for (std::size_t r = 0; r < view.extent(0); ++r)
      view(r, 0) *= scales_[r];
  }
  return brought(physical, Importer(rowMap_, givenMap_));
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
