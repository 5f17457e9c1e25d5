// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DofCopies.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>

namespace Harmos::feti::Details {
namespace {

std::vector<long long> dofsOf(const std::vector<ConstraintRow>& rows) {
  std::vector<long long> dofs;
  for (const ConstraintRow& row : rows)
    for (const ConstraintRow::Term& term : row.terms)
      dofs.push_back(term.dof);
  std::sort(dofs.begin(), dofs.end());
  dofs.erase(std::unique(dofs.begin(), dofs.end()), dofs.end());
  return dofs;
}

void sortBySubdomain(std::vector<Copy>& copies) {
  std::sort(copies.begin(), copies.end(), [](const Copy& a, const Copy& b) {
    return std::tie(a.subdomain, a.local) < std::tie(b.subdomain, b.local);
  });
}

bool isFixed(const std::vector<Copy>& copies) {
  return std::any_of(copies.begin(), copies.end(), [](const Copy& copy) { return copy.fixed != 0; });
}

} // namespace

DofCopies::DofCopies(const SubdomainSystem& system, const std::vector<ConstraintRow>& rows,
                     const std::vector<std::vector<double>>& weights)
    : comm_(*system.comm()) {
  long long most = std::numeric_limits<long long>::min();
  least_ = std::numeric_limits<long long>::max();
  for (int i = 0; i < system.size(); ++i)
    for (long long dof : system.subdomain(i).numbers) {
      least_ = std::min(least_, dof);
      most = std::max(most, dof);
    }
  least_ = globalMin(comm_, least_);
  most = globalMax(comm_, most);
  if (most < least_) // no subdomain has an interface
    least_ = most = 0;
  agree(comm_, [&] {
    for (const ConstraintRow& row : rows)
      for (const ConstraintRow::Term& term : row.terms)
        if (term.dof < least_ || term.dof > most)
          throw InputError("constraint row " + std::to_string(row.number) + " names dof " +
                           std::to_string(term.dof) + ", which no subdomain has");
  });
  width_ = std::max(1LL, (most - least_) / comm_.getSize() + 1);

  std::vector<std::vector<Copy>> sends(static_cast<std::size_t>(comm_.getSize()));
  for (int i = 0; i < system.size(); ++i) {
    const Subdomain& s = system.subdomain(i);
    std::map<int, const FixedDof*> fixed;
    for (const FixedDof& f : s.fixed)
      fixed[f.dof] = &f;
    for (std::size_t k = 0; k < s.numbers.size(); ++k) {
      const int local = (*s.interface)[k];
      const long long dof = s.numbers[k];
      const auto found = fixed.find(local);
      const double weight = weights.empty() ? 1.0 : weights[static_cast<std::size_t>(i)][k];
      sends[home(dof)].push_back({dof, s.number, found != fixed.end() ? found->second->value : 0.0, weight,
                                  local, i, comm_.getRank(), found != fixed.end() ? 1 : 0});
    }
  }
  for (const std::vector<Copy>& part : exchangeItems(comm_, sends))
    for (const Copy& copy : part)
      table_[copy.dof].push_back(copy);
  for (auto& item : table_)
    sortBySubdomain(item.second);
}

const std::vector<Copy>* DofCopies::Answers::of(long long dof) const {
  const auto known = name.find(dof);
  return known == name.end() ? nullptr : &copies.at(known->second);
}

bool DofCopies::Answers::isUnited(long long dof) const {
  const std::vector<Copy>& all = *of(dof);
  return std::any_of(all.begin(), all.end(), [&](const Copy& copy) { return copy.dof != dof; });
}

// @param dofs sorted, each once.
std::map<long long, long long> DofCopies::namesOf(const std::vector<long long>& dofs) const {
  std::vector<std::vector<long long>> questions(static_cast<std::size_t>(comm_.getSize()));
  for (long long dof : dofs)
    questions[home(dof)].push_back(dof);
  std::vector<std::vector<long long>> answers = exchangeItems(comm_, questions);
  for (std::vector<long long>& part : answers)
    for (long long& dof : part)
      if (const auto found = names_.find(dof); found != names_.end())
        dof = found->second;
  answers = exchangeItems(comm_, answers);
  std::map<long long, long long> result;
  for (std::size_t rank = 0; rank < answers.size(); ++rank)
    for (std::size_t k = 0; k < answers[rank].size(); ++k)
      result.emplace(questions[rank][k], answers[rank][k]);
  return result;
}

DofCopies::Answers DofCopies::ask(const std::vector<ConstraintRow>& rows) const {
  Answers result;
  result.name = namesOf(dofsOf(rows));
  std::vector<std::vector<long long>> questions(static_cast<std::size_t>(comm_.getSize()));
  for (const auto& [dof, name] : result.name)
    questions[home(name)].push_back(name);
  for (std::vector<long long>& part : questions) {
    std::sort(part.begin(), part.end());
    part.erase(std::unique(part.begin(), part.end()), part.end());
  }
  struct Answer {
    long long name;
    Copy copy;
  };
  const std::vector<std::vector<long long>> asked = exchangeItems(comm_, questions);
  std::vector<std::vector<Answer>> answers(asked.size());
  for (std::size_t r = 0; r < asked.size(); ++r)
    for (long long name : asked[r])
      if (const auto found = table_.find(name); found != table_.end())
        for (const Copy& copy : found->second)
          answers[r].push_back({name, copy});
  for (const std::vector<Answer>& part : exchangeItems(comm_, answers))
    for (const Answer& answer : part)
      result.copies[answer.name].push_back(answer.copy);
  for (auto item = result.name.begin(); item != result.name.end();)
    item = result.copies.count(item->second) > 0 ? std::next(item) : result.name.erase(item);
  return result;
}

// How many rows of all ranks name a dof.
std::map<long long, int> DofCopies::rowsAt(const std::vector<long long>& dofs,
                                           const std::vector<ConstraintRow>& rows) const {
  struct Count {
    long long dof;
    int rows;
  };
  std::map<long long, int> mine, total, result;
  for (const ConstraintRow& row : rows)
    for (const ConstraintRow::Term& term : row.terms)
      ++mine[term.dof];
  std::vector<std::vector<Count>> sends(static_cast<std::size_t>(comm_.getSize()));
  for (const auto& [dof, count] : mine)
    sends[home(dof)].push_back({dof, count});
  for (const std::vector<Count>& part : exchangeItems(comm_, sends))
    for (const Count& item : part)
      total[item.dof] += item.rows;
  std::vector<std::vector<Count>> questions(sends.size());
  for (long long dof : dofs)
    questions[home(dof)].push_back({dof, 0});
  std::vector<std::vector<Count>> answers = exchangeItems(comm_, questions);
  for (std::vector<Count>& part : answers)
    for (Count& item : part)
      item.rows = total.at(item.dof);
  for (const std::vector<Count>& part : exchangeItems(comm_, answers))
    for (const Count& item : part)
      result[item.dof] = item.rows;
  return result;
}

// Rows that glue, with their places; of the rows of this rank.
DofCopies::Glue DofCopies::glueAmong(const std::vector<ConstraintRow>& rows, bool all) const {
  // Mortar rows where meshes match are such to rounding: with weights they have to be told, for of rows that
  // depend on each other none is the larger then.
  const double rounding = all ? 1e-12 : 0.0;
  const auto isGlue = [rounding](const ConstraintRow& row) {
    return row.kind == ConstraintRow::Kind::Equality && row.terms.size() == 2 && row.bound == 0.0 &&
           row.compliance == 0.0 && row.terms[0].dof != row.terms[1].dof &&
           std::abs(row.terms[0].coefficient + row.terms[1].coefficient) <=
               rounding * std::abs(row.terms[0].coefficient) &&
           row.terms[0].coefficient != 0.0;
  };
  Glue glue;
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (isGlue(rows[r])) {
      glue.rows.push_back(rows[r]);
      glue.places.push_back(r);
    }
  if (globalSum(comm_, static_cast<long long>(glue.rows.size())) == 0)
    return glue;

  const Answers known = ask(glue.rows);
  const std::map<long long, int> naming = rowsAt(dofsOf(glue.rows), rows);
  Glue taken;
  for (std::size_t k = 0; k < glue.rows.size(); ++k) {
    const long long dofs[2] = {glue.rows[k].terms[0].dof, glue.rows[k].terms[1].dof};
    const std::vector<Copy>*first = known.of(dofs[0]), *second = known.of(dofs[1]);
    if (first == nullptr || second == nullptr || isFixed(*first) || isFixed(*second))
      continue;
    if (!all && naming.at(dofs[0]) < 2 && naming.at(dofs[1]) < 2)
      continue;
    taken.rows.push_back(glue.rows[k]);
    taken.places.push_back(glue.places[k]);
  }
  return taken;
}

// The lowest dof spreads along the rows until nothing changes. Returns the names of the dofs of these rows.
std::map<long long, long long> DofCopies::spreadNames(const std::vector<ConstraintRow>& glue) {
  const std::vector<long long> dofs = dofsOf(glue);
  struct Lower {
    long long dof, name;
  };
  while (true) {
    const std::map<long long, long long> name = namesOf(dofs);
    std::map<long long, long long> lower;
    for (const ConstraintRow& row : glue) {
      const long long least = std::min(name.at(row.terms[0].dof), name.at(row.terms[1].dof));
      for (const ConstraintRow::Term& term : row.terms)
        if (least < name.at(term.dof)) {
          const auto known = lower.emplace(term.dof, least).first;
          known->second = std::min(known->second, least);
        }
    }
    if (globalSum(comm_, static_cast<long long>(lower.size())) == 0)
      return name;
    std::vector<std::vector<Lower>> sends(static_cast<std::size_t>(comm_.getSize()));
    for (const auto& [dof, least] : lower)
      sends[home(dof)].push_back({dof, least});
    for (const std::vector<Lower>& part : exchangeItems(comm_, sends))
      for (const Lower& item : part) {
        const auto known = names_.emplace(item.dof, item.name).first;
        known->second = std::min(known->second, item.name);
      }
  }
}

// Copies go where their name is at home.
void DofCopies::moveCopies() {
  struct Moved {
    long long name;
    Copy copy;
  };
  std::vector<std::vector<Moved>> moves(static_cast<std::size_t>(comm_.getSize()));
  for (const auto& [dof, lowest] : names_) {
    for (const Copy& copy : table_.at(dof))
      moves[home(lowest)].push_back({lowest, copy});
    table_.erase(dof);
  }
  for (const std::vector<Moved>& part : exchangeItems(comm_, moves))
    for (const Moved& item : part)
      table_[item.name].push_back(item.copy);
}

std::vector<char> DofCopies::unite(const std::vector<ConstraintRow>& rows, bool all) {
  std::vector<char> isTaken(rows.size(), 0);
  const Glue glue = glueAmong(rows, all);
  if (globalSum(comm_, static_cast<long long>(glue.rows.size())) == 0)
    return isTaken;
  for (std::size_t place : glue.places)
    isTaken[place] = 1;
  const std::map<long long, long long> name = spreadNames(glue.rows);
  moveCopies();

  // The rows follow.
  std::vector<std::vector<Union>> sends(static_cast<std::size_t>(comm_.getSize()));
  for (std::size_t k = 0; k < glue.rows.size(); ++k) {
    const ConstraintRow::Term &first = glue.rows[k].terms[0], &second = glue.rows[k].terms[1];
    const long long lowest = name.at(first.dof);
    sends[home(lowest)].push_back({{first.dof, second.dof},
                                   first.coefficient,
                                   lowest,
                                   comm_.getRank(),
                                   static_cast<int>(glue.places[k])});
  }
  for (const std::vector<Union>& part : exchangeItems(comm_, sends))
    for (const Union& item : part)
      unions_[item.name].push_back(item);
  for (auto& [lowest, list] : unions_) {
    sortBySubdomain(table_.at(lowest));
    std::sort(list.begin(), list.end(), [](const Union& a, const Union& b) {
      return std::tie(a.dofs[0], a.dofs[1]) < std::tie(b.dofs[0], b.dofs[1]);
    });
  }
  return isTaken;
}

} // namespace Harmos::feti::Details
