// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_GivenRows.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Log.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <unordered_map>

namespace Harmos::feti::Details {

std::string dofText(const Copy& copy) {
  return "dof " + std::to_string(copy.dof) + " (subdomain " + std::to_string(copy.subdomain) + ")";
}

long long GivenCounts::first(ConstraintRow::Kind kind) const {
  return kind == ConstraintRow::Kind::Inequality ? 0
         : kind == ConstraintRow::Kind::Limited  ? inequalities
                                                 : inequalities + limited;
}

namespace {

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

// A dof of a row by the name that it goes by, with its copies.
struct NamedTerm {
  long long name;
  double coefficient;
  const std::vector<Copy>* copies;
  const Copy* fixed; // the first copy that is prescribed; null: none
};

// A row of prescribed values alone has to hold already: no force can change it. What is left of its bound.
double requireMet(const ConstraintRow& row, const std::vector<NamedTerm>& terms) {
  double value = 0.0, size = std::abs(row.bound);
  for (const NamedTerm& term : terms)
    if (term.fixed != nullptr) {
      value += term.coefficient * term.fixed->value;
      size = std::max(size, std::abs(term.coefficient * term.fixed->value));
    }
  const bool inequality = row.kind == ConstraintRow::Kind::Inequality;
  const double excess = inequality ? value - row.bound : std::abs(value - row.bound);
  // Prescribed values and gaps come from decks and coordinates.
  if (excess > std::max(1e-9 * size, row.rounding))
    throw InputError("prescribed displacements contradict " +
                         std::string(inequality ? "a contact or an obstacle" : "a tie") +
                         ": constraint row " + std::to_string(row.number) + " (" +
                         dofText(terms.front().copies->front()) +
                         ") contains prescribed values only, which violate it by " + scientific(excess) +
                         "; release a component there or move the obstacle",
                     {{"row", std::to_string(row.number)}});
  return -excess;
}

// By name: a dof named twice counts once, with the sum, and so do dofs that are united. Of what cancels there
// rounding errors would be left, which scaling makes a row of.
std::vector<NamedTerm> termsOf(const ConstraintRow& row, const DofCopies::Answers& answers) {
  constexpr double rounding = 1e-12; // as where contact rows are compared
  std::vector<NamedTerm> named;
  for (const ConstraintRow::Term& term : row.terms) {
    const auto known = answers.name.find(term.dof);
    if (known == answers.name.end())
      throw InputError("constraint row " + std::to_string(row.number) + " names dof " +
                           std::to_string(term.dof) + ", which is not an interface dof of any subdomain",
                       {{"dof", std::to_string(term.dof)}});
    named.push_back({known->second, term.coefficient, nullptr, nullptr});
  }
  std::stable_sort(named.begin(), named.end(),
                   [](const NamedTerm& a, const NamedTerm& b) { return a.name < b.name; });
  std::size_t count = 0;
  for (std::size_t first = 0, last = 0; first < named.size(); first = last) {
    NamedTerm sum = {named[first].name, 0.0, &answers.copies.at(named[first].name), nullptr};
    double size = 0.0;
    for (; last < named.size() && named[last].name == sum.name; ++last) {
      sum.coefficient += named[last].coefficient;
      size += std::abs(named[last].coefficient);
    }
    if (std::abs(sum.coefficient) <= rounding * size)
      sum.coefficient = 0.0;
    const auto fixed = std::find_if(sum.copies->begin(), sum.copies->end(),
                                    [](const Copy& copy) { return copy.fixed != 0; });
    sum.fixed = fixed == sum.copies->end() ? nullptr : &*fixed;
    named[count++] = sum;
  }
  named.resize(count);
  return named;
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
                         ") couples dofs that are tied to each other and violate it by " +
                         scientific(excess) + "; exclude this place from one of them",
                     {{"row", std::to_string(row.number)}});
}

// A prescribed value is no unknown: its share goes to the bound (equality rows may be added to any row), or
// the force of the row would move the trivial equation. A row of prescribed values alone stays as it is.
GivenRow byCopies(const ConstraintRow& row, const std::vector<NamedTerm>& terms) {
  GivenRow result;
  result.bound = row.bound;
  result.hasUnknown = std::any_of(terms.begin(), terms.end(), [](const NamedTerm& term) {
    return term.coefficient != 0.0 && term.fixed == nullptr;
  });
  for (const NamedTerm& term : terms) {
    double whole = 0.0;
    for (const Copy& copy : *term.copies)
      whole += copy.weight;
    for (const Copy& copy : *term.copies) {
      const double share = term.coefficient * copy.weight / whole;
      if (term.fixed != nullptr)
        result.held.push_back({copy, share});
      if (term.fixed != nullptr && result.hasUnknown)
        continue;
      result.terms.push_back({copy, share});
      result.norm2 += share * share / copy.weight;
    }
    if (term.fixed != nullptr && result.hasUnknown) {
      result.prescribed.push_back(term.coefficient * term.fixed->value);
      result.bound -= result.prescribed.back();
    }
  }
  return result;
}

// Σ coefficient · value over prescribed dofs.
double ofPrescribed(const std::vector<NamedTerm>& terms) {
  double sum = 0.0;
  for (const NamedTerm& term : terms)
    if (term.fixed != nullptr)
      sum += term.coefficient * term.fixed->value;
  return sum;
}

void requireNumbers(const ConstraintRow& row) {
  const std::string name = "constraint row " + std::to_string(row.number);
  const auto require = [&](double value, const char* what) {
    if (!(value >= 0.0) || !std::isfinite(value))
      throw InputError(name + " has a " + what + " of " + scientific(value) +
                           "; give a finite value of at least 0",
                       {{"row", std::to_string(row.number)}});
  };
  require(row.compliance, "compliance");
  require(row.limit, "limit");
  require(row.coefficient, "coefficient of friction");
  require(row.softness.value_or(0.0), "softness");
  if (row.status != ConstraintRow::Status::Undecided &&
      (row.kind != ConstraintRow::Kind::Inequality || row.softness))
    throw InputError(name +
                         " is marked open or closed, which is valid only for inequalities without softness",
                     {{"row", std::to_string(row.number)}});
  if (row.softness && row.kind == ConstraintRow::Kind::Equality)
    throw InputError(name + " is an equality with a softness; give it a compliance, or make it a limited row",
                     {{"row", std::to_string(row.number)}});
}

// The force of an inequality that pulls and has no unknowns would be known, but moves what is prescribed:
// there is to be none.
void requireUnstretched(const ConstraintRow& row, double gap) {
  if (row.softness && gap > row.rounding)
    throw InputError("constraint row " + std::to_string(row.number) +
                         " is soft and contains prescribed or tied values only, which stretch it by " +
                         scientific(gap) + "; remove its softness or release a component there",
                     {{"row", std::to_string(row.number)}});
}

// No force of a row without unknowns moves anything.
void settle(GivenRow& given, const ConstraintRow& row, const std::vector<NamedTerm>& terms,
            const DofCopies::Answers& answers, DirichletForm form, double softness) {
  const bool isJoined = given.norm2 == 0.0 && namesUnited(row, answers);
  if (!(given.norm2 > 0.0 || isJoined) || !std::isfinite(given.norm2) || !std::isfinite(given.bound))
    throw InputError("constraint row " + std::to_string(row.number) +
                     " is zero or not finite; check its coefficients and its gap");
  requireNumbers(row);
  given.compliance = row.compliance;
  if (given.hasUnknown)
    return;
  const bool isLimited = row.kind == ConstraintRow::Kind::Limited;
  // Slips that bodies themselves undo when the force is the limit are a thousand times as large.
  constexpr double small = 1e-3;
  if (isLimited && row.compliance == 0.0)
    given.compliance = small * softness;
  if (given.compliance > 0.0) {
    given.isIdle = true;
    given.bound -= ofPrescribed(terms);
    given.norm2 = isJoined ? 1.0 : given.norm2;
    if (isLimited && std::abs(given.bound) <= row.rounding)
      given.bound = 0.0;
    if (!isLimited)
      requireUnstretched(row, given.bound);
  } else if (isJoined) {
    requireJoined(row, terms.front().copies->front());
    requireUnstretched(row, row.bound);
    given.isIdle = true;
    given.bound = 0.0;
    given.norm2 = 1.0;
  } else {
    const double left = requireMet(row, terms);
    requireUnstretched(row, left);
    // Beside the rows of its dofs' prescribed values it would be a dependent one, which the preconditioner
    // could not tell from those.
    const bool inequality = row.kind == ConstraintRow::Kind::Inequality;
    given.isIdle = inequality && form == DirichletForm::Dual;
    given.bound = given.isIdle ? std::max(0.0, left) : given.bound;
  }
}

} // namespace

GivenCounts countGiven(const Teuchos::Comm<int>& comm, const std::vector<ConstraintRow>& rows) {
  std::array<long long, 3> mine = {0, 0, 0};
  for (const ConstraintRow& row : rows)
    ++mine[row.kind == ConstraintRow::Kind::Inequality ? 0
           : row.kind == ConstraintRow::Kind::Limited  ? 1
                                                       : 2];
  const GivenCounts counts = {globalSum(comm, mine[0]), globalSum(comm, mine[1]), globalSum(comm, mine[2])};
  checkNumbers(comm, rows, ConstraintRow::Kind::Inequality, counts.inequalities);
  checkNumbers(comm, rows, ConstraintRow::Kind::Limited, counts.limited);
  checkNumbers(comm, rows, ConstraintRow::Kind::Equality, counts.equalities);
  return counts;
}

GivenRow givenRow(const ConstraintRow& row, const DofCopies::Answers& answers, DirichletForm form,
                  double softness) {
  const std::vector<NamedTerm> terms = termsOf(row, answers);
  GivenRow given = byCopies(row, terms);
  settle(given, row, terms, answers, form, softness);
  return given;
}

std::vector<std::array<std::size_t, 2>> discsOf(const std::vector<ConstraintRow>& rows) {
  std::map<long long, std::vector<std::size_t>> places;
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (rows[r].kind == ConstraintRow::Kind::Limited && rows[r].disc >= 0)
      places[rows[r].disc].push_back(r);
  std::vector<std::array<std::size_t, 2>> pairs;
  for (const auto& [disc, members] : places) {
    const auto ofOneDisc = [](const ConstraintRow& a, const ConstraintRow& b) {
      return a.limit == b.limit && a.normal == b.normal && a.coefficient == b.coefficient &&
             a.softness.has_value() == b.softness.has_value();
    };
    if (members.size() != 2 || !ofOneDisc(rows[members[0]], rows[members[1]]))
      throw InputError("disc " + std::to_string(disc) + " of limited rows has " +
                           std::to_string(members.size()) +
                           " of them on this rank or an incompatible pair; give two rows with the same limit "
                           "and equal softness on the same rank",
                       {{"disc", std::to_string(disc)}});
    pairs.push_back({members[0], members[1]});
  }
  return pairs;
}

std::vector<std::array<std::size_t, 2>> followersOf(const std::vector<ConstraintRow>& rows) {
  const auto follows = [](const ConstraintRow& row) {
    return row.kind == ConstraintRow::Kind::Limited && row.normal >= 0;
  };
  std::vector<std::array<std::size_t, 2>> result;
  if (std::none_of(rows.begin(), rows.end(), follows))
    return result;
  std::unordered_map<long long, std::size_t> inequalities;
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (rows[r].kind == ConstraintRow::Kind::Inequality)
      inequalities.emplace(rows[r].number, r);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (!follows(rows[r]))
      continue;
    const std::string name = "limited row " + std::to_string(rows[r].number);
    const auto normal = inequalities.find(rows[r].normal);
    if (normal == inequalities.end())
      throw InputError(name + " follows the force of inequality " + std::to_string(rows[r].normal) +
                           ", which is not on this rank; give both on the same rank",
                       {{"row", std::to_string(rows[r].number)}});
    if (rows[normal->second].status != ConstraintRow::Status::Undecided)
      throw InputError(name + " follows the force of inequality " + std::to_string(rows[r].normal) +
                           ", which is marked open or closed; leave it undecided",
                       {{"row", std::to_string(rows[r].number)}});
    if (rows[r].limit != 0.0)
      throw InputError(name + " has a limit of its own and one that follows inequality " +
                           std::to_string(rows[r].normal) + "; remove one of them",
                       {{"row", std::to_string(rows[r].number)}});
    result.push_back({r, normal->second});
  }
  return result;
}

std::vector<long long> numbersOfGiven(const Teuchos::Comm<int>& comm, const std::vector<ConstraintRow>& rows,
                                      const std::vector<char>& isTaken, const GivenCounts& counts) {
  std::vector<long long> numbers;
  long long taken = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    numbers.push_back(counts.first(rows[r].kind) + rows[r].number);
    taken += isTaken[r];
  }
  if (globalSum(comm, taken) == 0)
    return numbers;
  // Those with lower numbers are counted where ranges of numbers meet.
  const long long width = counts.equalities / comm.getSize() + 1;
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
  long long next =
      counts.first(ConstraintRow::Kind::Equality) + exclusiveScan(comm, static_cast<long long>(order.size()));
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

} // namespace Harmos::feti::Details
