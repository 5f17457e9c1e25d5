// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DesignRecord.hpp"

#include <algorithm>
#include <sstream>

namespace Harmos::shape {

DesignRecord::DesignRecord(sensitivity::DesignFunction& function, std::function<void()> before)
    : function_(function), before_(std::move(before)) {}

const DesignRecord::Answer* DesignRecord::recalled(What what, const std::vector<double>& design,
                                                   double tolerance) {
  if (!isRecalling())
    return nullptr;
  const Answer& answer = answers_[next_];
  const What kind = answer.what == What::Refused ? What::Value : answer.what;
  if (kind == what && answer.design == design && answer.tolerance == tolerance)
    return &answers_[next_++];
  // From here on it is another run.
  forgotten_ = recalled_ - next_;
  answers_.resize(next_);
  recalled_ = next_;
  return nullptr;
}

double DesignRecord::value(const std::vector<double>& design, double tolerance) {
  if (const Answer* known = recalled(What::Value, design, tolerance)) {
    ++values_;
    refused_ += known->what == What::Refused ? 1 : 0;
    if (known->what == What::Refused)
      throw sensitivity::RefusedDesign(known->refusal);
    return known->numbers.front();
  }
  before_();
  ++values_;
  try {
    const double value = function_.value(design, tolerance);
    answers_.push_back({What::Value, tolerance, design, {value}, ""});
  } catch (const sensitivity::RefusedDesign& error) {
    answers_.push_back({What::Refused, tolerance, design, {}, error.what()});
    next_ = recalled_ = answers_.size();
    ++refused_;
    throw;
  }
  next_ = recalled_ = answers_.size();
  return answers_.back().numbers.front();
}

std::vector<double> DesignRecord::gradient(const std::vector<double>& design, double tolerance) {
  if (const Answer* known = recalled(What::Gradient, design, tolerance))
    return known->numbers;
  answers_.push_back({What::Gradient, tolerance, design, function_.gradient(design, tolerance), ""});
  next_ = recalled_ = answers_.size();
  return answers_.back().numbers;
}

std::vector<double> DesignRecord::derived(const std::vector<double>& design,
                                          const std::function<std::vector<double>()>& make) {
  if (const Answer* known = recalled(What::Derived, design, 0.0))
    return known->numbers;
  answers_.push_back({What::Derived, 0.0, design, make(), ""});
  next_ = recalled_ = answers_.size();
  return answers_.back().numbers;
}

// Each answer: what, tolerance, length of the design, the design, and its numbers.
void DesignRecord::exchange(qp::StateArchive<MultiVector>& archive) {
  std::vector<double> all;
  for (const Answer& answer : answers_) {
    all.insert(all.end(),
               {static_cast<double>(answer.what), answer.tolerance, static_cast<double>(answer.design.size()),
                static_cast<double>(answer.numbers.size())});
    all.insert(all.end(), answer.design.begin(), answer.design.end());
    all.insert(all.end(), answer.numbers.begin(), answer.numbers.end());
  }
  archive.numbers("answers at designs", all);
  if (!archive.isReading())
    return;
  answers_.clear();
  for (auto at = all.begin(); at + 4 <= all.end();) {
    Answer answer;
    answer.what = static_cast<What>(static_cast<int>(at[0]));
    answer.tolerance = at[1];
    const auto design = static_cast<std::ptrdiff_t>(at[2]), numbers = static_cast<std::ptrdiff_t>(at[3]);
    at += 4;
    HARMOS_REQUIRE(at + design + numbers <= all.end(), "the record of designs in the checkpoint is cut off");
    answer.design.assign(at, at + design);
    answer.numbers.assign(at + design, at + design + numbers);
    at += design + numbers;
    answers_.push_back(std::move(answer));
  }
  next_ = 0;
  recalled_ = answers_.size();
}

std::string DesignRecord::refusals() const {
  std::string lines;
  for (const Answer& answer : answers_)
    if (answer.what == What::Refused) {
      std::string line = answer.refusal;
      std::replace(line.begin(), line.end(), '\n', ' ');
      lines += line + "\n";
    }
  return lines;
}

void DesignRecord::setRefusals(const std::string& lines) {
  std::istringstream text(lines);
  for (Answer& answer : answers_)
    if (answer.what == What::Refused)
      std::getline(text, answer.refusal);
}

} // namespace Harmos::shape
