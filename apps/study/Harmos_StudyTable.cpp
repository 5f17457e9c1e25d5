// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StudyTable.hpp"

#include "Harmos_AtomicFile.hpp"
#include "Harmos_Errors.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <sstream>

namespace Harmos::study {

std::vector<std::string> splitCsv(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t k = 0; k < line.size(); ++k) {
    const char c = line[k];
    if (quoted && c == '"' && k + 1 < line.size() && line[k + 1] == '"') {
      fields.back() += '"';
      ++k;
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

std::string joinCsv(const std::vector<std::string>& fields) {
  std::string line;
  for (std::size_t k = 0; k < fields.size(); ++k) {
    std::string field;
    for (char c : fields[k]) {
      field += c == '\n' ? ' ' : c; // a row is a line
      if (c == '"')
        field += c;
    }
    const bool quotes = field.find_first_of(",\"") != std::string::npos;
    line += (k > 0 ? "," : "") + (quotes ? '"' + field + '"' : field);
  }
  return line;
}

double numberOf(const Row& row, const std::string& column) {
  const std::string& text = row.at(column);
  return text.empty() ? std::numeric_limits<double>::quiet_NaN() : std::strtod(text.c_str(), nullptr);
}

std::string textOf(double value) {
  if (!std::isfinite(value))
    return "";
  std::ostringstream text;
  text.precision(6);
  text << value;
  return text.str();
}

Table::Table(const Plan& plan, std::vector<std::string> columns)
    : path_(plan.output + "/study.csv"), columns_(std::move(columns)) {
  std::ifstream stream(path_);
  std::string line;
  if (!std::getline(stream, line))
    return;
  const auto refuse = [&](const std::string& why) {
    throw InputError("\"" + path_ + "\" " + why + "; use another directory with --output or remove it",
                     {{"file", path_}});
  };
  if (splitCsv(line) != columns_)
    refuse("is a table of another study: its columns differ");
  while (std::getline(stream, line)) {
    const std::vector<std::string> fields = splitCsv(line);
    if (fields.size() != columns_.size())
      refuse("has a row of " + std::to_string(fields.size()) + " fields under " +
             std::to_string(columns_.size()) + " columns");
    Row row;
    for (std::size_t k = 0; k < fields.size(); ++k)
      row[columns_[k]] = fields[k];
    if (row["study"] != plan.fingerprint)
      refuse("is a table of another study: deck, common assignments or reference differ");
    rows_.push_back(std::move(row));
  }
}

const Row* Table::find(const Plan& plan, const Setting& setting, int ranks) const {
  const auto at = std::find_if(rows_.begin(), rows_.end(), [&](const Row& row) {
    for (std::size_t a = 0; a < plan.axes.size(); ++a)
      if (row.at(plan.axes[a].name) != plan.axes[a].text(setting[a]))
        return false;
    return row.at("ranks") == std::to_string(ranks);
  });
  return at == rows_.end() ? nullptr : &*at;
}

void Table::add(Row row) {
  rows_.push_back(std::move(row));
  std::string text = joinCsv(columns_) + "\n";
  for (const Row& each : rows_) {
    std::vector<std::string> fields;
    for (const std::string& column : columns_)
      fields.push_back(each.at(column));
    text += joinCsv(fields) + "\n";
  }
  io::writeAtomically(path_, text);
}

} // namespace Harmos::study
