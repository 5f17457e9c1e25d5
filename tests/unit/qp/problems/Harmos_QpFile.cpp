// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_QpFile.hpp"

#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace Harmos {
namespace {

class Words {
 public:
  explicit Words(std::string path) : path_(std::move(path)), file_(path_) {
    if (!file_)
      throw std::runtime_error("cannot open " + path_);
  }

  // Streams do not read "inf".
  double number() {
    std::string word;
    if (!(file_ >> word))
      throw std::runtime_error(path_ + " ends early");
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    if (*end != '\0')
      throw std::runtime_error(path_ + ": \"" + word + "\" is no number");
    return value;
  }
  int count() { return static_cast<int>(number()); }

  std::vector<double> vector(int n) {
    std::vector<double> values;
    for (int i = 0; i < n; ++i)
      values.push_back(number());
    return values;
  }

  void entries(int number, Dense& matrix) {
    for (int k = 0; k < number; ++k) {
      const int row = count(), column = count();
      if (row < 0 || row >= matrix.rows || column < 0 || column >= matrix.columns)
        throw std::runtime_error(path_ + ": an entry lies outside of its matrix");
      matrix(row, column) += this->number();
    }
  }

 private:
  std::string path_;
  std::ifstream file_;
};

} // namespace

SmallQp readQp(const std::string& path) {
  Words words(path);
  const int n = words.count(), m = words.count(), entries = words.count();
  SmallQp qp{Dense(n, n), {}, {}, {}, Dense(m, n), {}};
  words.entries(entries, qp.a);
  qp.b = words.vector(n);
  qp.lower = words.vector(n);
  qp.upper = words.vector(n);
  words.entries(words.count(), qp.c);
  qp.cRhs = words.vector(m);
  return qp;
}

} // namespace Harmos
