// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_NetcdfHeader.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>

namespace Harmos::fem::Details {
namespace {

/// Goes through a header; what does not fit ends it by Unsound.
class Header {
 public:
  struct Unsound {};

  explicit Header(const std::string& path)
      : file_(path, std::ios::binary), left_(std::filesystem::file_size(path)) {}

  void check() {
    std::array<char, 4> magic{};
    file_.read(magic.data(), magic.size());
    if (!file_ || magic[0] != 'C' || magic[1] != 'D' || magic[2] != 'F')
      return; // of another format
    left_ -= magic.size();
    const bool isWide = magic[3] == 5;
    width_ = isWide ? 8 : 4;
    offset_ = magic[3] == 1 ? 4 : 8;
    number(width_); // of records
    list([&] {      // dimensions
      name();
      number(width_);
    });
    attributes();
    list([&] { // variables
      name();
      skip(count() * width_); // its dimensions
      attributes();
      number(4);
      number(width_);
      number(offset_);
    });
  }

 private:
  std::uint64_t number(std::uint64_t bytes) {
    std::uint64_t result = 0;
    if (left_ < bytes)
      throw Unsound();
    left_ -= bytes;
    for (std::uint64_t k = 0; k < bytes; ++k)
      result = result << 8 | static_cast<unsigned char>(file_.get());
    return result;
  }

  void skip(std::uint64_t bytes) {
    if (left_ < bytes)
      throw Unsound();
    left_ -= bytes;
    file_.seekg(static_cast<std::streamoff>(bytes), std::ios::cur);
  }

  static std::uint64_t padded(std::uint64_t bytes) { return (bytes + 3) / 4 * 4; }

  // A length that fits into what is left.
  std::uint64_t count() {
    const std::uint64_t result = number(width_);
    if (result > left_)
      throw Unsound();
    return result;
  }

  void name() { skip(padded(count())); }

  template<class Item>
  void list(const Item& item) {
    number(4); // what it is a list of
    for (std::uint64_t k = count(); k > 0; --k)
      item();
  }

  void attributes() {
    list([&] {
      constexpr std::array<std::uint64_t, 12> sizes = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8}; // of types
      name();
      const std::uint64_t type = number(4), values = count();
      if (type == 0 || type >= sizes.size())
        throw Unsound();
      skip(padded(values * sizes[type]));
    });
  }

  std::ifstream file_;
  std::uint64_t left_, width_ = 4, offset_ = 4; // bytes of the file, of a number, of a place in the file
};

} // namespace

bool isSoundNetcdf(const std::string& path) {
  try {
    Header(path).check();
    return true;
  } catch (const Header::Unsound&) {
    return false;
  }
}

} // namespace Harmos::fem::Details
