// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Rates.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_NearestName.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <map>

namespace Harmos::feti {
namespace {

// Each name and where its rate stands.
template<class AnyRates>
auto tableOf(AnyRates& rates) {
  return std::vector<std::pair<std::string, decltype(&rates.local.sparseFlops)>>{
      {"sparse_flops", &rates.local.sparseFlops},
      {"schur_flops", &rates.local.schurFlops},
      {"dense_flops", &rates.local.denseFlops},
      {"setup_entries", &rates.local.setupEntries},
      {"setup_rows", &rates.local.setupRows},
      {"solve_bytes", &rates.local.solveBytes},
      {"sparse_bytes", &rates.local.sparseBytes},
      {"stream_bytes", &rates.local.streamBytes},
      {"read_bytes", &rates.step.readBytes},
      {"coarse_entries", &rates.step.coarseEntries},
      {"coarse_from_memory", &rates.step.coarseFromMemory},
      {"latency", &rates.step.latency},
      {"bandwidth", &rates.step.bandwidth},
      {"overhead", &rates.step.overhead}};
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// Products and set-ups are by one factor faster or slower than by the rates that stand here.
void takeDualOperator(const nlohmann::json& runs, Rates& rates) {
  std::map<std::string, std::vector<double>> faster;
  for (const nlohmann::json& run : runs) {
    const std::string form = run.at("form");
    const bool shared = run.at("shared");
    if (run.at("precision") != "double")
      continue;
    faster["setup"].push_back(run.at("expected_setup_seconds").get<double>() /
                              run.at("setup_seconds").get<double>());
    faster[form + (shared ? " shared" : "")].push_back(run.at("expected_product_seconds").get<double>() /
                                                       run.at("product_seconds").get<double>());
  }
  const auto by = [&](const std::string& name, std::initializer_list<double*> which) {
    if (faster.count(name) > 0)
      for (double* rate : which)
        *rate *= median(faster[name]);
  };
  by("setup",
     {&rates.local.sparseFlops, &rates.local.schurFlops, &rates.local.setupEntries, &rates.local.setupRows});
  by("condensed shared", {&rates.local.denseFlops});
  by("condensed", {&rates.local.streamBytes, &rates.step.readBytes});
  by("implicit", {&rates.local.solveBytes, &rates.local.sparseBytes});
}

void takeCoarseFactor(const nlohmann::json& runs, Rates& rates) {
  std::vector<double> small, large;
  for (const nlohmann::json& run : runs)
    (run.at("entries").get<double>() < 5e5 ? small : large)
        .push_back(run.at("entries_per_second").get<double>());
  if (!small.empty())
    rates.step.coarseEntries = median(small);
  if (!large.empty())
    rates.step.coarseFromMemory = median(large);
}

void takeNames(const nlohmann::json& object, Rates& rates, const std::string& path) {
  const auto table = tableOf(rates);
  std::vector<std::string> names;
  for (const auto& item : table)
    names.push_back(item.first);
  for (const auto& [name, value] : object.items()) {
    const std::string& wanted = name;
    const auto found =
        std::find_if(table.begin(), table.end(), [&](const auto& item) { return item.first == wanted; });
    if (found == table.end())
      throw InputError("\"" + path + "\": unknown rate \"" + name + "\"" + offer(name, names),
                       {{"file", path}});
    if (!value.is_number() || !(value.template get<double>() > 0.0))
      throw InputError("\"" + path + "\": the rate \"" + name + "\" is not a positive number",
                       {{"file", path}});
    *found->second = value.template get<double>();
  }
}

} // namespace

Rates ratesFromFile(const std::string& path) {
  std::ifstream file(path);
  if (!file)
    throw InputError("cannot read the rates \"" + path + "\"; check the path", {{"file", path}});
  Rates rates;
  rates.source = path;
  try {
    const nlohmann::json json = nlohmann::json::parse(file);
    if (!json.is_object())
      throw InputError("\"" + path + "\" is not a JSON object of rates", {{"file", path}});
    const std::string benchmark = json.contains("benchmark") ? json.at("benchmark").get<std::string>() : "";
    if (benchmark == "dual_operator")
      takeDualOperator(json.at("runs"), rates);
    else if (benchmark == "coarse_factor")
      takeCoarseFactor(json.at("runs"), rates);
    else if (!benchmark.empty())
      throw InputError("\"" + path + "\" belongs to the benchmark \"" + benchmark +
                           "\"; rates are taken from dual_operator and coarse_factor",
                       {{"file", path}});
    else
      takeNames(json, rates, path);
  } catch (const nlohmann::json::exception& error) {
    throw InputError("\"" + path + "\" is not a valid JSON file of rates: " + error.what(), {{"file", path}});
  }
  return rates;
}

std::vector<std::pair<std::string, double>> namedRates(const Rates& rates) {
  std::vector<std::pair<std::string, double>> result;
  for (const auto& [name, rate] : tableOf(rates))
    result.emplace_back(name, *rate);
  return result;
}

} // namespace Harmos::feti
