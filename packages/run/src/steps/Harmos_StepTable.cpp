// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StepTable.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <iomanip>
#include <sstream>

namespace Harmos::run {
namespace {

// As a field of a CSV file (RFC 4180).
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos)
    return text;
  std::string result = "\"";
  for (char c : text)
    result += (c == '"' ? "\"" : "") + std::string(1, c);
  return result + "\"";
}

const fem::Point& forceOf(const StepRow& row, const std::string& path) {
  const auto force = std::find_if(row.forces.begin(), row.forces.end(),
                                  [&](const Forces::Of& effect) { return effect.path == path; });
  HARMOS_REQUIRE(force != row.forces.end(), "\"" + path + "\" exerts no force");
  return force->resultant.force;
}

double valueOf(const scene::Scene& scene, const scene::Measure& measure, const StepRow& row) {
  if (!measure.component)
    return scene.timeline.factor(*measure.effect, row.time);
  const auto at = std::find(scene.effects.begin(), scene.effects.end(), measure.effect);
  HARMOS_REQUIRE(at != scene.effects.end(), "the measure \"" + measure.name + "\" is of no effect");
  const std::string path = scene.effectPaths()[static_cast<std::size_t>(at - scene.effects.begin())];
  return forceOf(row, path)[*measure.component];
}

} // namespace

std::vector<std::pair<std::string, double>> StepRow::numbers() const {
  return {{"step", step},
          {"time", time},
          {"converged", converged ? 1.0 : 0.0},
          {"products", products},
          {"active_sets", activeSets},
          {"energy", energy},
          {"external_work", externalWork},
          {"dissipated", dissipated},
          {"released", released},
          {"closed", static_cast<double>(closed)},
          {"open", static_cast<double>(open)},
          {"sticking", static_cast<double>(sticking)},
          {"slipping", static_cast<double>(slipping)},
          {"broken", static_cast<double>(broken)}};
}

std::string csvLine(const StepRow& row) {
  std::ostringstream text;
  text << std::setprecision(17);
  const char* separator = "";
  for (const auto& item : row.numbers()) {
    text << separator << item.second;
    separator = ",";
  }
  for (const Forces::Of& effect : row.forces)
    for (double component : effect.resultant.force)
      text << ',' << component;
  for (const auto& item : row.further)
    text << ',' << item.second;
  text << '\n';
  return text.str();
}

std::vector<std::string> furtherColumns(const scene::Scene& scene) {
  std::vector<std::string> columns;
  for (const std::string& name : scene.timeline.names())
    columns.push_back("history/" + name);
  for (const scene::Measure& measure : scene.measures)
    columns.push_back(measure.name);
  if (scene.iterates())
    columns.insert(columns.end(), {"newton", "factorisations"});
  if (scene.isTransient()) {
    columns.insert(columns.end(), {"kinetic", "damped", "momentum/x", "momentum/y", "momentum/z"});
    for (const std::string& path : scene.contactPaths())
      for (const char* component : {"/x", "/y", "/z"})
        columns.push_back("impulse/" + path + component);
  }
  return columns;
}

void tellFurther(const scene::Scene& scene, const StepRow* before, StepRow& row) {
  row.further.clear();
  const std::vector<std::string> columns = furtherColumns(scene);
  for (const std::string& name : scene.timeline.names())
    row.further.emplace_back(columns[row.further.size()], scene.timeline.factor(name, row.time));
  for (const scene::Measure& measure : scene.measures)
    row.further.emplace_back(measure.name, measure.scale * valueOf(scene, measure, row));
  if (scene.iterates()) {
    row.further.emplace_back("newton", static_cast<double>(row.newton));
    row.further.emplace_back("factorisations", static_cast<double>(row.factorisations));
  }
  if (scene.isTransient()) {
    row.further.emplace_back("kinetic", row.kinetic);
    row.further.emplace_back("damped", row.isDamped ? 1.0 : 0.0);
    for (std::size_t d = 0; d < 3; ++d)
      row.further.emplace_back(std::string("momentum/") + "xyz"[d], row.momentum[d]);
    for (const std::string& path : scene.contactPaths())
      for (std::size_t d = 0; d < 3; ++d) {
        const std::size_t place = row.further.size();
        const double time = before == nullptr ? 0.0 : before->time,
                     force = before == nullptr ? 0.0 : forceOf(*before, path)[d],
                     impulse = before == nullptr ? 0.0 : before->further[place].second;
        const double now = forceOf(row, path)[d];
        row.further.emplace_back(columns[place],
                                 impulse + (row.time - time) * (row.isDamped ? now : 0.5 * (force + now)));
      }
  }
}

std::string toCsv(const std::vector<StepRow>& rows, const std::vector<std::string>& paths,
                  const std::vector<std::string>& further) {
  std::string text;
  for (const auto& item : StepRow().numbers())
    text += (text.empty() ? "" : ",") + item.first;
  for (const std::string& path : paths)
    for (const char* component : {"/fx", "/fy", "/fz"})
      text += "," + field(path + component);
  for (const std::string& column : further)
    text += "," + field(column);
  text += "\n";
  for (const StepRow& row : rows)
    text += csvLine(row);
  return text;
}

void exchange(qp::StateArchive<MultiVector>& archive, std::vector<StepRow>& rows,
              const std::vector<std::string>& paths) {
  std::vector<double> values;
  for (const StepRow& row : rows) {
    for (const auto& item : row.numbers())
      values.push_back(item.second);
    values.push_back(static_cast<double>(row.newton));
    values.push_back(static_cast<double>(row.factorisations));
    values.push_back(row.kinetic);
    values.push_back(row.isDamped ? 1.0 : 0.0);
    values.insert(values.end(), row.momentum.begin(), row.momentum.end());
    for (const Forces::Of& effect : row.forces)
      for (const fem::Point* vector : {&effect.resultant.force, &effect.resultant.moment})
        values.insert(values.end(), vector->begin(), vector->end());
  }
  archive.numbers("rows of steps", values);
  if (!archive.isReading())
    return;
  const std::size_t width = StepRow().numbers().size() + 7 + 6 * paths.size();
  if (values.size() % width != 0)
    throw InputError("the steps of the checkpoint have the forces of other effects; restart with the deck of "
                     "the run that wrote it");
  rows.clear();
  for (std::size_t begin = 0; begin < values.size(); begin += width) {
    const double* v = values.data() + begin;
    StepRow row;
    row.step = static_cast<int>(v[0]);
    row.time = v[1];
    row.converged = v[2] != 0.0;
    row.products = static_cast<int>(v[3]);
    row.activeSets = static_cast<int>(v[4]);
    row.energy = v[5];
    row.externalWork = v[6];
    row.dissipated = v[7];
    row.released = v[8];
    long long* counts[] = {&row.closed, &row.open, &row.sticking, &row.slipping, &row.broken};
    for (std::size_t k = 0; k < 5; ++k)
      *counts[k] = static_cast<long long>(v[9 + k]);
    row.newton = static_cast<long long>(v[14]);
    row.factorisations = static_cast<long long>(v[15]);
    row.kinetic = v[16];
    row.isDamped = v[17] != 0.0;
    std::copy_n(v + 18, 3, row.momentum.begin());
    const double* force = v + 21;
    for (const std::string& path : paths) {
      Forces::Of& effect = row.forces.emplace_back();
      effect.path = path;
      std::copy(force, force + 3, effect.resultant.force.begin());
      std::copy(force + 3, force + 6, effect.resultant.moment.begin());
      force += 6;
    }
    rows.push_back(std::move(row));
  }
}

} // namespace Harmos::run
