// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_UniversalGroups.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

namespace Harmos::fem::Details {
namespace {

// Numbers that a dataset has of each entity; 0: it has no groups.
std::size_t numbersOfEntity(int dataset) {
  static const std::map<int, std::size_t> known = {{2429, 2}, {2430, 2}, {2432, 2}, {2435, 4},
                                                   {2452, 4}, {2467, 4}, {2477, 4}};
  const auto found = known.find(dataset);
  return found == known.end() ? 0 : found->second;
}

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r"), end = text.find_last_not_of(" \t\r");
  return begin == std::string::npos ? "" : text.substr(begin, end + 1 - begin);
}

class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path), file_(path) {}

  std::vector<UniversalGroup> groups() {
    while (next()) {
      if (trimmed(line_) != "-1" || !next())
        continue;
      const std::size_t width = numbersOfEntity(static_cast<int>(std::strtol(line_.c_str(), nullptr, 10)));
      while (next() && trimmed(line_) != "-1")
        if (width > 0)
          readGroup(width);
    }
    return std::move(groups_);
  }

 private:
  bool next() {
    ++number_;
    return static_cast<bool>(std::getline(file_, line_));
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError("\"" + path_ + "\" cannot be read: line " + std::to_string(number_) + " " + what +
                     "; the file is damaged");
  }

  std::vector<long long> numbers() const {
    std::istringstream text(line_);
    std::vector<long long> result;
    for (long long number = 0; text >> number;)
      result.push_back(number);
    if (!text.eof())
      fail("of a group is no row of integers");
    return result;
  }

  // From its first line on.
  void readGroup(std::size_t width) {
    const std::vector<long long> head = numbers();
    if (head.size() < 8 || head.back() < 0)
      fail("is no head of a group");
    if (!next())
      fail("ends within a group");
    UniversalGroup& group = named(trimmed(line_), head.front());
    std::size_t left = static_cast<std::size_t>(head.back());
    while (left > 0) {
      if (!next() || trimmed(line_) == "-1")
        fail("ends within the group \"" + group.name + "\"");
      const std::vector<long long> row = numbers();
      if (row.empty() || row.size() % width != 0 || row.size() / width > left)
        fail("of the group \"" + group.name + "\" has " + std::to_string(row.size()) + " numbers");
      left -= row.size() / width;
      for (std::size_t k = 0; k < row.size(); k += width)
        add(group, row[k], row[k + 1]);
    }
  }

  static void add(UniversalGroup& group, long long type, long long number) {
    constexpr long long node = 7, element = 8;
    if (type == node)
      group.nodes.push_back(number);
    else if (type == element)
      group.elements.push_back(number);
  }

  UniversalGroup& named(const std::string& given, long long number) {
    const std::string name = given.empty() ? std::to_string(number) : given;
    const auto found = std::find_if(groups_.begin(), groups_.end(),
                                    [&](const UniversalGroup& group) { return group.name == name; });
    if (found != groups_.end())
      return *found;
    groups_.push_back({name, {}, {}});
    return groups_.back();
  }

  std::string path_;
  std::ifstream file_;
  std::string line_;
  long long number_ = 0;
  std::vector<UniversalGroup> groups_;
};

} // namespace

bool isUniversal(const std::string& path) {
  return std::filesystem::path(path).extension() == ".unv";
}

std::vector<UniversalGroup> readUniversalGroups(const std::string& path) {
  return Reader(path).groups();
}

} // namespace Harmos::fem::Details
