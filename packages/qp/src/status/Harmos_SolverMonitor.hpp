// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_QpTypes.hpp"

#include <functional>
#include <string>
#include <type_traits>
#include <vector>

namespace Harmos::qp {

template<class MV>
struct IterationState;

/// Carries what a solver knows to where it is kept, or back from there. A class describes its state once, by
/// calls that serve both ways, so that what is written and what is read cannot differ.
///
/// All calls are collective, with equal names in equal order on all ranks.
template<class MV>
class StateArchive {
 public:
  virtual ~StateArchive() = default;

  /// Whether values come from the archive.
  virtual bool isReading() const = 0;
  /// Numbers that are the same on every rank. Reading, they get the size that was written.
  /// @throws InputError on all ranks if there are none of that name.
  virtual void numbers(const std::string& name, std::vector<double>& values) = 0;
  /// Columns in the space of the solution. Reading, x has the shape that was written.
  virtual void vector(const std::string& name, MV& x) = 0;
  /// A vector in the space of the equality rows, as the solver uses them.
  virtual void rowVector(const std::string& name, MV& x) = 0;

  /// A number, a truth value or an enumerator; integers are exact up to 2⁵³.
  template<class T>
  void number(const std::string& name, T& value) {
    static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
    std::vector<double> one;
    if (!isReading())
      one.push_back(static_cast<double>(value));
    numbers(name, one);
    if (isReading())
      value = static_cast<T>(one.at(0));
  }
};

/// Looks after a solver while it works: is told of every iteration, may keep what the solver knows in order
/// to go on from there in another run, and may ask it to stop.
template<class MV>
class SolverMonitor {
 public:
  using Archive = StateArchive<MV>;
  /// Describes all that a solver knows, to an archive.
  using Exchange = std::function<void(Archive&)>;

  enum class Wish { GoOn, Save, SaveAndStop };

  virtual ~SolverMonitor() = default;

  /// A row of the history is there. Not collective, and called on every rank.
  virtual void recorded(const IterationRecord& record) = 0;

  /// Is asked before every step, at a point from which the solver can go on in another run. The answer has to
  /// be the same on all ranks. @note Collective.
  virtual Wish ask(const IterationState<MV>& state) = 0;

  /// Keeps the state. A state that cannot be kept is no reason for the solver to stop. @note Collective.
  virtual void save(const Exchange& state) = 0;

  /// Whether there is a state to go on from, instead of from the problem's initial guess.
  virtual bool hasState() const = 0;
  /// Whether that state has numbers of this name.
  virtual bool holds(const std::string& name) const = 0;
  /// Brings part of it back. @throws InputError on all ranks if it does not fit the problem.
  /// @note Collective.
  virtual void restore(const Exchange& state) = 0;
};

/// A solver's counters and history.
template<class MV>
void exchangeResult(StateArchive<MV>& archive, const std::string& prefix, Result& result) {
  archive.number(prefix + "hessian norm", result.hessianNorm);
  archive.number(prefix + "penalty reached", result.penalty);
  std::vector<double> values = toNumbers(result.counters);
  archive.numbers(prefix + "counters", values);
  std::vector<double> table = toNumbers(result.history);
  archive.numbers(prefix + "history", table);
  if (!archive.isReading())
    return;
  result.counters = countersOf(values);
  result.history = historyOf(table);
}

} // namespace Harmos::qp
