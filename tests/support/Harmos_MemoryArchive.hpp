// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_SolverMonitor.hpp"
#include "Harmos_StatusTest.hpp"

#include <BelosMultiVecTraits.hpp>

#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace Harmos {

/// What a solver described, by name.
template<class MV>
struct MemoryState {
  std::map<std::string, std::vector<double>> numbers;
  std::map<std::string, Teuchos::RCP<MV>> vectors;
};

/// An archive that does not leave the memory.
template<class MV>
class MemoryArchive : public qp::StateArchive<MV> {
 public:
  MemoryArchive(MemoryState<MV>& state, bool reading) : state_(state), reading_(reading) {}

  bool isReading() const override { return reading_; }
  void numbers(const std::string& name, std::vector<double>& values) override {
    if (reading_)
      values = state_.numbers.at(name);
    else if (!state_.numbers.emplace(name, values).second)
      throw std::logic_error(name + " is written twice");
  }
  void vector(const std::string& name, MV& x) override {
    using Traits = Belos::MultiVecTraits<double, MV>;
    if (reading_)
      Traits::Assign(*state_.vectors.at(name), x);
    else if (!state_.vectors.emplace(name, Traits::CloneCopy(x)).second)
      throw std::logic_error(name + " is written twice");
  }
  void rowVector(const std::string& name, MV& x) override { vector(name, x); }

 private:
  MemoryState<MV>& state_;
  bool reading_;
};

/// Keeps the state before every step, or goes on from one.
template<class MV>
class MemoryMonitor : public qp::SolverMonitor<MV> {
 public:
  using Exchange = typename qp::SolverMonitor<MV>::Exchange;
  using Wish = typename qp::SolverMonitor<MV>::Wish;

  std::vector<MemoryState<MV>> saved;
  std::vector<qp::IterationRecord> rows;
  const MemoryState<MV>* resumed = nullptr;
  /// Steps after which the solver is asked to stop; negative for never.
  int stopAfter = -1;

  void recorded(const qp::IterationRecord& record) override { rows.push_back(record); }
  Wish ask(const qp::IterationState<MV>&) override {
    if (resumed != nullptr)
      return Wish::GoOn;
    return stopAfter >= 0 && static_cast<int>(saved.size()) == stopAfter ? Wish::SaveAndStop : Wish::Save;
  }
  void save(const Exchange& state) override {
    saved.emplace_back();
    MemoryArchive<MV> archive(saved.back(), false);
    state(archive);
  }
  bool hasState() const override { return resumed != nullptr; }
  bool holds(const std::string& name) const override { return resumed->numbers.count(name) > 0; }
  void restore(const Exchange& state) override {
    MemoryState<MV> copy = *resumed;
    MemoryArchive<MV> archive(copy, true);
    state(archive);
  }
};

} // namespace Harmos
