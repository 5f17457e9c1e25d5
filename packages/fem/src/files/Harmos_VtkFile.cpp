// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_VtkFile.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

namespace Harmos::fem {
namespace {

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw InputError("\"" + path + "\" cannot be read: " + what);
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && lower(text).compare(text.size() - end.size(), end.size(), end) == 0;
}

struct NumberType {
  const char* name; // of both kinds of files, in lower case
  std::size_t bytes;
  char kind; // i, u, f
};

const NumberType numberTypes[] = {{"char", 1, 'i'},
                                  {"unsigned_char", 1, 'u'},
                                  {"short", 2, 'i'},
                                  {"unsigned_short", 2, 'u'},
                                  {"int", 4, 'i'},
                                  {"unsigned_int", 4, 'u'},
                                  {"long", 8, 'i'},
                                  {"unsigned_long", 8, 'u'},
                                  {"vtkidtype", 4, 'i'},
                                  {"vtktypeint64", 8, 'i'},
                                  {"float", 4, 'f'},
                                  {"double", 8, 'f'},
                                  {"vtktypeint32", 4, 'i'},
                                  {"int8", 1, 'i'},
                                  {"uint8", 1, 'u'},
                                  {"int16", 2, 'i'},
                                  {"uint16", 2, 'u'},
                                  {"int32", 4, 'i'},
                                  {"uint32", 4, 'u'},
                                  {"int64", 8, 'i'},
                                  {"uint64", 8, 'u'},
                                  {"float32", 4, 'f'},
                                  {"float64", 8, 'f'},
                                  {"long_long", 8, 'i'},
                                  {"unsigned_long_long", 8, 'u'}};

const NumberType& numberType(const std::string& path, const std::string& name) {
  const std::string wanted = lower(name);
  for (const NumberType& type : numberTypes)
    if (wanted == type.name)
      return type;
  fail(path,
       "it contains numbers of the unknown type \"" + name + "\"; save it again with ParaView or meshio");
}

template<class Number, class As>
As number(const char* bytes, bool isSwapped) {
  char own[sizeof(Number)];
  std::memcpy(own, bytes, sizeof(Number));
  if (isSwapped)
    std::reverse(own, own + sizeof(Number));
  Number value;
  std::memcpy(&value, own, sizeof(Number));
  return static_cast<As>(value);
}

template<class As>
As numberAt(const char* bytes, const NumberType& type, bool isSwapped) {
  switch (type.kind) {
  case 'f':
    return type.bytes == 4 ? number<float, As>(bytes, isSwapped) : number<double, As>(bytes, isSwapped);
  case 'u':
    return type.bytes == 1   ? number<std::uint8_t, As>(bytes, isSwapped)
           : type.bytes == 2 ? number<std::uint16_t, As>(bytes, isSwapped)
           : type.bytes == 4 ? number<std::uint32_t, As>(bytes, isSwapped)
                             : number<std::uint64_t, As>(bytes, isSwapped);
  default:
    return type.bytes == 1   ? number<std::int8_t, As>(bytes, isSwapped)
           : type.bytes == 2 ? number<std::int16_t, As>(bytes, isSwapped)
           : type.bytes == 4 ? number<std::int32_t, As>(bytes, isSwapped)
                             : number<std::int64_t, As>(bytes, isSwapped);
  }
}

template<class As>
std::vector<As> numbersOf(const std::string& path, const char* bytes, std::size_t size,
                          const std::string& name, std::size_t count, bool isSwapped) {
  const NumberType& type = numberType(path, name);
  if (count > size / type.bytes)
    fail(path, "it is truncated or damaged");
  std::vector<As> values;
  values.reserve(count);
  for (std::size_t k = 0; k < count; ++k)
    values.push_back(numberAt<As>(bytes + k * type.bytes, type, isSwapped));
  return values;
}

bool isLittleEndian() {
  const std::uint16_t one = 1;
  char first = 0;
  std::memcpy(&first, &one, 1);
  return first == 1;
}

/// Words, lines and blocks of numbers of a legacy file.
class LegacyReader {
 public:
  LegacyReader(const std::string& path, const std::string& text) : path_(path), text_(text) {}

  VtkGrid read() {
    if (line().rfind("# vtk DataFile Version", 0) != 0)
      fail(path_, "its first line is not \"# vtk DataFile Version …\"");
    line(); // a title
    const std::string kind = lower(word());
    if (kind != "ascii" && kind != "binary")
      fail(path_, "its third line is neither ASCII nor BINARY");
    isBinary_ = kind == "binary";
    expect("dataset");
    const std::string grid = lower(word());
    if (grid != "unstructured_grid")
      fail(path_,
           "it holds a data set of the kind " + grid +
               ", but bodies are made of an unstructured grid; in ParaView, Append Datasets makes one of it");
    for (std::string name = lower(word()); !name.empty(); name = lower(word()))
      section(name);
    return std::move(grid_);
  }

 private:
  void section(const std::string& name) {
    if (name == "points") {
      const std::size_t count = size();
      const std::string type = word();
      grid_.points = reals(type, 3 * count);
    } else if (name == "cells") {
      cells();
    } else if (name == "cell_types") {
      const std::size_t count = size();
      for (long long type : integers("int", count))
        grid_.types.push_back(static_cast<int>(type));
    } else if (name == "cell_data" || name == "point_data") {
      tuples_ = size();
      ofCells_ = name == "cell_data";
    } else {
      attribute(name);
    }
  }

  // Version 5.1 has offsets, as many as cells and one; those before a list of counts and nodes.
  void cells() {
    const std::size_t first = size(), second = size();
    const std::size_t here = at_;
    if (lower(word()) == "offsets") {
      const std::string type = word();
      grid_.offsets = integers(type, first);
      if (!grid_.offsets.empty())
        grid_.offsets.erase(grid_.offsets.begin());
      expect("connectivity");
      const std::string nodeType = word();
      grid_.nodes = integers(nodeType, second);
      return;
    }
    at_ = here;
    const std::vector<long long> list = integers("int", second);
    std::size_t k = 0;
    for (std::size_t cell = 0; cell < first; ++cell) {
      if (k >= list.size() || list[k] < 0 || static_cast<std::size_t>(list[k]) > list.size() - k - 1)
        fail(path_, "its list of cells is inconsistent");
      const auto nodes = static_cast<std::size_t>(list[k++]);
      grid_.nodes.insert(grid_.nodes.end(), list.begin() + static_cast<std::ptrdiff_t>(k),
                         list.begin() + static_cast<std::ptrdiff_t>(k + nodes));
      grid_.offsets.push_back(static_cast<long long>(grid_.nodes.size()));
      k += nodes;
    }
  }

  void attribute(const std::string& name) {
    if (name == "scalars") {
      const std::string own = word(), type = word();
      const std::size_t here = at_;
      std::string components = word();
      if (lower(components) == "lookup_table") {
        at_ = here;
        components = "1";
      }
      expect("lookup_table");
      word();
      keep(own, type, static_cast<std::size_t>(std::strtoul(components.c_str(), nullptr, 10)), tuples_);
    } else if (name == "field") {
      word();
      for (std::size_t arrays = size(); arrays > 0; --arrays) {
        std::string own = word();
        while (lower(own) == "metadata") {
          metadata();
          own = word();
        }
        const std::size_t components = size(), tuples = size();
        const std::string type = word();
        keep(own, type, components, tuples);
      }
    } else if (name == "vectors" || name == "normals" || name == "tensors") {
      const std::string own = word(), type = word();
      keep(own, type, name == "tensors" ? 9 : 3, tuples_);
    } else if (name == "lookup_table") {
      word();
      const std::size_t colours = size();
      isBinary_ ? skip(4 * colours) : static_cast<void>(reals("float", 4 * colours));
    } else if (name == "metadata") {
      metadata();
    } else {
      fail(path_, "it holds \"" + name +
                      "\" where points, cells or their data were expected; save it as version " +
                      "4.2 from ParaView or meshio, without data");
    }
  }

  // Up to an empty line.
  void metadata() {
    line();
    while (at_ < text_.size() && !line().empty()) {
    }
  }

  void keep(const std::string& name, const std::string& type, std::size_t components, std::size_t tuples) {
    if (lower(type) == "string" || lower(type) == "bit")
      fail(path_, "it holds data of the type " + type + "; save it without");
    if (!ofCells_ || components != 1 || !Details::isIntegral(type))
      static_cast<void>(reals(type, components * tuples));
    else
      grid_.data[name] = integers(type, tuples);
  }

  std::string line() {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string result = text_.substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    if (!result.empty() && result.back() == '\r')
      result.pop_back();
    return result;
  }

  std::string word() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0)
      ++at_;
    const std::size_t begin = at_;
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) == 0)
      ++at_;
    return text_.substr(begin, at_ - begin);
  }

  void expect(const std::string& name) {
    const std::string found = word();
    if (lower(found) != name)
      fail(path_, "it holds \"" + found + "\" where \"" + name + "\" was expected");
  }

  std::size_t size() {
    const std::string text = word();
    char* end = nullptr;
    const unsigned long long value = std::strtoull(text.c_str(), &end, 10);
    if (text.empty() || *end != '\0' || value > text_.size())
      fail(path_, "it holds \"" + text + "\" where a number of entries was expected, or ends before them");
    return static_cast<std::size_t>(value);
  }

  const char* binary(std::size_t bytes) {
    if (at_ < text_.size() && text_[at_] == '\r')
      ++at_;
    ++at_; // the end of the line
    if (at_ > text_.size() || bytes > text_.size() - at_)
      fail(path_, "it is truncated or damaged");
    at_ += bytes;
    return text_.data() + (at_ - bytes);
  }
  void skip(std::size_t bytes) { binary(bytes); }

  std::vector<double> reals(const std::string& type, std::size_t count) {
    if (isBinary_) {
      const std::size_t bytes = count * Details::bytesOf(path_, type);
      return Details::realsOf(path_, binary(bytes), bytes, type, count, isLittleEndian());
    }
    std::vector<double> values;
    for (std::size_t k = 0; k < count; ++k) {
      const std::string text = word();
      char* end = nullptr;
      values.push_back(std::strtod(text.c_str(), &end));
      if (text.empty() || *end != '\0')
        fail(path_, text.empty() ? "it ends early" : "it holds \"" + text + "\" where a number was expected");
    }
    return values;
  }

  std::vector<long long> integers(const std::string& type, std::size_t count) {
    if (isBinary_) {
      const std::size_t bytes = count * Details::bytesOf(path_, type);
      return Details::integersOf(path_, binary(bytes), bytes, type, count, isLittleEndian());
    }
    std::vector<long long> values;
    for (double value : reals("double", count))
      values.push_back(static_cast<long long>(value));
    return values;
  }

  const std::string& path_;
  const std::string& text_;
  std::size_t at_ = 0;
  bool isBinary_ = false;
  std::size_t tuples_ = 0;
  bool ofCells_ = false;
  VtkGrid grid_;
};

void check(const std::string& path, const VtkGrid& grid) {
  const auto points = static_cast<long long>(grid.points.size() / 3);
  if (grid.types.size() != grid.offsets.size())
    fail(path, "it has " + std::to_string(grid.offsets.size()) + " cells, and types of " +
                   std::to_string(grid.types.size()));
  long long before = 0;
  for (long long end : grid.offsets) {
    if (end < before || end > static_cast<long long>(grid.nodes.size()))
      fail(path, "its list of cells is inconsistent");
    before = end;
  }
  for (long long node : grid.nodes)
    if (node < 0 || node >= points)
      fail(path, "a cell has the node " + std::to_string(node) + ", but nodes are numbered from 0 to " +
                     std::to_string(points - 1));
  for (const auto& [name, values] : grid.data)
    if (values.size() != grid.types.size())
      fail(path, "the data \"" + name + "\" of its cells are " + std::to_string(values.size()) +
                     " numbers for " + std::to_string(grid.types.size()) + " cells");
}

} // namespace

namespace Details {

std::size_t bytesOf(const std::string& path, const std::string& type) {
  return numberType(path, type).bytes;
}

bool isIntegral(const std::string& type) {
  const std::string wanted = lower(type);
  return std::any_of(std::begin(numberTypes), std::end(numberTypes),
                     [&](const NumberType& known) { return wanted == known.name && known.kind != 'f'; });
}

std::vector<double> realsOf(const std::string& path, const char* bytes, std::size_t size,
                            const std::string& type, std::size_t count, bool isSwapped) {
  return numbersOf<double>(path, bytes, size, type, count, isSwapped);
}

std::vector<long long> integersOf(const std::string& path, const char* bytes, std::size_t size,
                                  const std::string& type, std::size_t count, bool isSwapped) {
  return numbersOf<long long>(path, bytes, size, type, count, isSwapped);
}

} // namespace Details

bool isVtk(const std::string& path) {
  return endsWith(path, ".vtk") || endsWith(path, ".vtu");
}

VtkGrid readVtk(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (!file)
    fail(path, "the file cannot be opened; check its permissions");
  VtkGrid grid = endsWith(path, ".vtu") ? Details::readVtu(path, text) : LegacyReader(path, text).read();
  check(path, grid);
  return grid;
}

} // namespace Harmos::fem
