// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_FormChoice.hpp"
#include "Harmos_StepModel.hpp"

#include <string>
#include <utility>
#include <vector>

namespace Harmos::feti {

/// Rates of a machine, by which forms are chosen and runs planned.
struct Rates {
  MachineRates local;
  StepRates step;
  std::string source = "one core of an AMD EPYC; network assumed, not measured";
};

/// Rates from a JSON file: an object of names as MachineRates and StepRates have them in snake case
/// ("dense_flops": 5e10), or what tests/performance/dual_operator or tests/performance/coarse_factor writes.
/// @throws InputError naming what is wrong. Local.
Rates ratesFromFile(const std::string& path);
/// The same, name by name, as plan.json has them.
std::vector<std::pair<std::string, double>> namedRates(const Rates& rates);

} // namespace Harmos::feti
