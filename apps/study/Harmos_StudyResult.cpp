// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StudyResult.hpp"

#include "Harmos_Version.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace Harmos::study {
namespace {

using Json = nlohmann::ordered_json;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

std::string rounded(double value, int digits) {
  std::ostringstream text;
  text.precision(digits);
  text << value;
  return text.str();
}

// "1e-2" of 0.01.
std::string exponent(double value, int digits = 0) {
  std::string text = scientific(value, digits);
  const std::size_t zero = text.find("e-0");
  if (zero != std::string::npos)
    text.erase(zero + 2, 1);
  return text;
}

bool mayBeJudged(const Point& point, std::size_t measure) {
  return point.converged && point.isJudged[measure];
}

void markFront(std::vector<Point>& points, std::size_t measure) {
  for (Point& point : points) {
    point.ratioToFront[measure] = nan;
    if (!mayBeJudged(point, measure))
      continue;
    double least = point.seconds;
    bool dominated = false;
    for (const Point& other : points) {
      if (!mayBeJudged(other, measure) || other.error[measure] > point.error[measure])
        continue;
      least = std::min(least, other.seconds);
      dominated = dominated || other.seconds < point.seconds ||
                  (other.seconds == point.seconds && other.error[measure] < point.error[measure]);
    }
    point.onFront[measure] = !dominated;
    point.ratioToFront[measure] = point.seconds / least;
  }
}

// "energy norm to 1e-2: h = 1/64, tolerance 1e-2: 0.031 s (error 8.1e-3)".
std::string sentence(const Plan& plan, const std::vector<Point>& points, std::size_t measure, double target) {
  const Point *cheapest = nullptr, *best = nullptr;
  for (const Point& point : points) {
    if (!mayBeJudged(point, measure))
      continue;
    if (point.error[measure] <= target && (cheapest == nullptr || point.seconds < cheapest->seconds))
      cheapest = &point;
    if (best == nullptr || point.error[measure] < best->error[measure])
      best = &point;
  }
  const std::string begin = measureTitles[measure] + " to " + exponent(target) + ": ";
  const auto told = [&](const Point& point) {
    return plan.label(point.setting) + ": " + rounded(point.seconds, 2) + " s (error " +
           exponent(point.error[measure], 1) + ")";
  };
  if (cheapest != nullptr)
    return begin + told(*cheapest);
  if (best == nullptr)
    return begin + "no run can be judged: the reference is not ten times better than any";
  return begin + "no run that can be judged reaches it; the most accurate is " + told(*best);
}

// What the values of an axis have in common: how far from the front they are.
Json valuesOf(const Plan& plan, std::size_t a, const std::vector<Point>& points) {
  const Axis& axis = plan.axes[a];
  Json values = Json::array();
  for (std::size_t value = 0; value < axis.values.size(); ++value) {
    Json entry;
    entry["value"] = axis.text(value);
    entry["label"] = axis.labels[value];
    for (std::size_t k = 0; k < measuresOf(plan); ++k) {
      std::vector<double> ratios;
      int onFront = 0;
      for (const Point& point : points)
        if (point.setting[a] == value && std::isfinite(point.ratioToFront[k])) {
          ratios.push_back(point.ratioToFront[k]);
          onFront += point.onFront[k] ? 1 : 0;
        }
      entry["ratio_to_front"][measureNames[k]] = {
          {"runs", ratios.size()},
          {"on_front", onFront},
          {"median", ratios.empty() ? Json(nullptr) : Json(median(ratios))},
          {"largest",
           ratios.empty() ? Json(nullptr) : Json(*std::max_element(ratios.begin(), ratios.end()))}};
    }
    values.push_back(entry);
  }
  return values;
}

Json runOf(const Plan& plan, const Point& point) {
  const Row& row = *point.row;
  Json run;
  for (std::size_t a = 0; a < plan.axes.size(); ++a)
    run["settings"][plan.axes[a].name] = plan.axes[a].text(point.setting[a]);
  run["label"] = plan.label(point.setting);
  run["git"] = row.at("git");
  run["converged"] = point.converged;
  run["reason"] = row.at("reason");
  run["dual_operator"] = row.at("dual_operator");
  run["solver"] = row.at("solver");
  for (const char* column :
       {"repetitions", "primal_dimension", "dual_dimension", "subdomains", "products", "iterations",
        "outer_iterations", "tight_tolerance", "memory_mib", "estimated_error"})
    run[column] = number(numberOf(row, column));
  for (const auto& [column, text] : row)
    if (column.rfind("seconds_", 0) == 0)
      run["seconds"][column.substr(8)] = number(numberOf(row, column));
  run["seconds"]["total"] = number(point.seconds);
  for (std::size_t k = 0; k < measuresOf(plan); ++k) {
    const std::string& name = measureNames[k];
    Json& errors = run["errors"][name];
    errors["total"] = number(point.error[k]);
    for (const char* part : {"discretisation", "solver", "local", "reference"})
      errors[part] = number(numberOf(row, name + "_" + part));
    errors["judged"] = point.isJudged[k];
    errors["discretisation_judged"] = row.at(name + "_discretisation_judged") == "yes";
    errors["on_front"] = point.onFront[k];
    errors["ratio_to_front"] = number(point.ratioToFront[k]);
  }
  run["solver_judged"] = row.at("solver_judged") == "yes";
  return run;
}

} // namespace

Result::Result(const Plan& plan, const Table& table, int ranks) {
  for (const Setting& setting : plan.settings()) {
    const Row* row = table.find(plan, setting, ranks);
    if (row == nullptr)
      continue;
    Point point{setting, row, numberOf(*row, "seconds"), row->at("converged") == "yes", {}, {}, {}, {}};
    for (std::size_t k = 0; k < measuresOf(plan); ++k) {
      point.error[k] = numberOf(*row, measureNames[k] + "_error");
      point.isJudged[k] = row->at(measureNames[k] + "_judged") == "yes";
    }
    points.push_back(std::move(point));
  }
  for (std::size_t k = 0; k < measuresOf(plan); ++k) {
    markFront(points, k);
    const bool isMeasured = std::any_of(points.begin(), points.end(),
                                        [&](const Point& point) { return std::isfinite(point.error[k]); });
    for (double target : plan.targets)
      if (isMeasured)
        sentences.push_back(sentence(plan, points, k, target));
  }
}

std::string toJson(const Plan& plan, const Table& table, const Result& result, int ranks) {
  Json json;
  json["harmos"] = {{"version", version()}, {"git", gitHash()}};
  json["study"] = table.rows().empty() ? "" : plan.fingerprint;
  json["deck"] = plan.studyDeck;
  json["application"] = plan.application.name;
  json["application_deck"] = plan.deck;
  json["set"] = plan.common;
  json["ranks"] = ranks;
  json["reference"] = {{"set", plan.reference}, {"coarser", plan.coarser}, {"coarsest", plan.coarsest}};
  json["targets"] = plan.targets;
  for (std::size_t a = 0; a < plan.axes.size(); ++a)
    json["axes"].push_back({{"name", plan.axes[a].name},
                            {"parameters", plan.axes[a].parameters},
                            {"values", valuesOf(plan, a, result.points)}});
  json["measures"] = Json::object();
  for (std::size_t k = 0; k < measuresOf(plan); ++k)
    json["measures"][measureNames[k]] = measureTitles[k];
  json["runs"] = Json::array();
  for (const Point& point : result.points)
    json["runs"].push_back(runOf(plan, point));
  json["sentences"] = result.sentences;
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

} // namespace Harmos::study
