// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_StudyPlan.hpp"

#include <map>
#include <string>
#include <vector>

namespace Harmos::study {

/// A row of study.csv: a text for each column.
using Row = std::map<std::string, std::string>;

/// study.csv: a row a run, kept by what it was run with, so that a study that was ended goes on where it was.
///
/// Local: rank 0's.
class Table {
 public:
  /// Reads what is there. @throws InputError for a file that is no table of this study: of other axes,
  /// another reference or other common assignments.
  Table(const Plan& plan, std::vector<std::string> columns);

  /// The row of a setting on so many ranks, or null.
  const Row* find(const Plan& plan, const Setting& setting, int ranks) const;
  /// Adds a row and writes the file; the file is always whole.
  void add(Row row);

  const std::vector<Row>& rows() const { return rows_; }

 private:
  std::string path_;
  std::vector<std::string> columns_;
  std::vector<Row> rows_;
};

/// Comma separated values of one line; quotes and doubled quotes as in RFC 4180.
std::vector<std::string> splitCsv(const std::string& line);
std::string joinCsv(const std::vector<std::string>& fields);

/// The number in a field; NaN if it is empty.
double numberOf(const Row& row, const std::string& column);
/// With six digits; empty for what is not finite.
std::string textOf(double value);

} // namespace Harmos::study
