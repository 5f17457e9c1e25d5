// SPDX-License-Identifier: BSD-3-Clause

/// The part of Constraints that changes: bounds, limits, softness and statuses.

#include "Harmos_Agreement.hpp"
#include "Harmos_BuiltRows.hpp"
#include "Harmos_Constraints.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_Import.hpp>
#include <Tpetra_Map.hpp>
#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace Harmos::feti {
namespace {

using Status = ConstraintRow::Status;

std::vector<std::vector<double>> prescribedOf(const SubdomainSystem& system) {
  std::vector<std::vector<double>> values;
  for (int i = 0; i < system.size(); ++i) {
    values.emplace_back();
    for (const FixedDof& fixed : system.subdomain(i).fixed)
      values.back().push_back(fixed.value);
  }
  return values;
}

bool areZero(const std::vector<std::vector<double>>& values) {
  return std::all_of(values.begin(), values.end(), [](const std::vector<double>& part) {
    return std::all_of(part.begin(), part.end(), [](double value) { return value == 0.0; });
  });
}

// But for what may change.
bool isSameRow(const ConstraintRow& a, const ConstraintRow& b) {
  const auto sameTerm = [](const ConstraintRow::Term& x, const ConstraintRow::Term& y) {
    return x.dof == y.dof && x.coefficient == y.coefficient;
  };
  return a.kind == b.kind && a.number == b.number && a.compliance == b.compliance &&
         a.softness == b.softness && a.limit == b.limit && a.disc == b.disc &&
         a.coefficient == b.coefficient && a.normal == b.normal && a.terms.size() == b.terms.size() &&
         std::equal(a.terms.begin(), a.terms.end(), b.terms.begin(), sameTerm);
}

} // namespace

void Constraints::keepGiven(const std::vector<ConstraintRow>& rows, const Details::BuiltRows& built) {
  given_ = rows;
  prescribed_ = prescribedOf(*system_);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Details::GivenRow& part = built.parts[r];
    const bool isPlain = built.isTaken[r] == 0 && part.hasUnknown && !part.isIdle &&
                         rows[r].kind == ConstraintRow::Kind::Inequality && !rows[r].softness;
    standings_.push_back({isPlain                 ? Standing::Plain
                          : built.isTaken[r] != 0 ? Standing::Taken
                                                  : Standing::Other,
                          part.prescribed,
                          {}});
  }
}

void Constraints::setBounds(const std::vector<ConstraintRow>& rows) {
  if (setPlainBounds(rows))
    return;
  const Constraints changed(*system_, rows, hasWeights_, weights_);
  agree(*system_->comm(), [&] {
    if (!areOfOneKind(changed) || changed.entries_ != entries_ ||
        changed.standings_.size() != standings_.size())
      throw InputError("setBounds() changes bounds only, but the number, kinds, dofs, coefficients or "
                       "compliances of constraint rows differ (with weights, also a nonzero bound of a row "
                       "that glues two dofs); create new constraints");
  });
  takeBounds(changed);
}

// Where bounds and statuses of inequalities with unknowns alone change, nothing has to be found out anew:
// what was taken from their bounds stays, or is zero where all prescribed values are. @return whether that is
// so, on all ranks.
bool Constraints::setPlainBounds(const std::vector<ConstraintRow>& rows) {
  std::vector<std::vector<double>> prescribed = prescribedOf(*system_);
  bool isPlain = rows.size() == given_.size() && !hasFollowers(), onlyPlain = true;
  for (std::size_t r = 0; isPlain && r < rows.size(); ++r) {
    const Standing standing = standings_[r].standing;
    const bool isMine = standing == Standing::Plain;
    const bool stays = rows[r].bound == given_[r].bound && rows[r].status == given_[r].status;
    isPlain = isSameRow(rows[r], given_[r]) && (isMine ? std::isfinite(rows[r].bound) : stays);
    onlyPlain = onlyPlain && (isMine || (standing == Standing::Taken && rows[r].bound == 0.0));
  }
  std::vector<double> differs = {isPlain && prescribed == prescribed_ ? 0.0 : 1.0,
                                 isPlain && onlyPlain && areZero(prescribed) ? 0.0 : 1.0};
  globalMax(*system_->comm(), differs);
  const bool isSame = differs[0] == 0.0;
  if (!isSame && differs[1] != 0.0)
    return false;
  changePlain(rows, isSame);
  given_ = rows;
  prescribed_ = std::move(prescribed);
  for (Given& given : standings_)
    for (double& part : given.subtracted)
      part = isSame ? part : 0.0;
  return true;
}

// @param isSame whether prescribed values are, or all of them zero.
void Constraints::changePlain(const std::vector<ConstraintRow>& rows, bool isSame) {
  MultiVector given(givenImport_->getTargetMap(), 3), owned(rowMap_, 3); // bound, status, whether it is one
  double rounding2 = 0.0;
  {
    const auto view = given.getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (std::size_t k = 0; k < view.extent(0); ++k)
      view(k, 0) = view(k, 1) = view(k, 2) = 0.0;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      if (standings_[r].standing == Standing::Taken)
        continue;
      const MultiplierTerm& term = standings_[r].multiplier.front();
      rounding2 += std::pow(term.factor * rows[r].rounding, 2);
      if (standings_[r].standing != Standing::Plain)
        continue;
      double bound = rows[r].bound;
      for (double part : standings_[r].subtracted)
        bound -= isSame ? part : 0.0;
      const auto place = static_cast<std::size_t>(term.place);
      view(place, 0) = term.factor * bound;
      view(place, 1) = static_cast<double>(static_cast<int>(rows[r].status));
      view(place, 2) = 1.0;
    }
  }
  owned.putScalar(0.0);
  owned.doExport(given, *givenImport_, Tpetra::ADD);
  const auto view = owned.getLocalViewHost(Tpetra::Access::ReadOnly);
  std::vector<Change> changes;
  for (std::size_t r = 0; r < view.extent(0); ++r) {
    const int row = static_cast<int>(r);
    changes.push_back(view(r, 2) != 0.0
                          ? Change{view(r, 0), static_cast<Status>(static_cast<int>(view(r, 1)))}
                          : Change{isSame ? bound(row) : 0.0, status(row)});
  }
  change(*system_->comm(), changes, rounding2);
}

Constraints Constraints::withBounds(const SubdomainSystem& system,
                                    const std::vector<ConstraintRow>& rows) const {
  Constraints other = *this;
  other.system_ = &system;
  other.setBounds(rows);
  return other;
}

void Constraints::takeBounds(const Constraints& changed) {
  static_cast<RowConditions&>(*this) = changed;
  given_ = changed.given_;
  prescribed_ = changed.prescribed_;
  for (std::size_t r = 0; r < standings_.size(); ++r) {
    standings_[r].standing = changed.standings_[r].standing;
    standings_[r].subtracted = changed.standings_[r].subtracted;
  }
}

} // namespace Harmos::feti
