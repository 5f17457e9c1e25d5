// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_VtkFile.hpp"

#include <zlib.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <sstream>

namespace Harmos::fem {
namespace {

[[noreturn]] void failVtu(const std::string& path, const std::string& what) {
  throw InputError("\"" + path + "\" cannot be read: " + what);
}

/// <Name attribute="value" …>
struct Tag {
  std::string name; // "/Name" where it ends one
  std::map<std::string, std::string> attributes;
  std::size_t end = 0;  // of what it says
  bool isEmpty = false; // <Name …/>

  std::string get(const std::string& attribute, const std::string& otherwise = "") const {
    const auto found = attributes.find(attribute);
    return found == attributes.end() ? otherwise : found->second;
  }
};

Tag tagAt(const std::string& text, std::size_t begin) {
  Tag tag;
  std::size_t at = begin + 1;
  const auto isBlank = [&](std::size_t k) { return std::isspace(static_cast<unsigned char>(text[k])) != 0; };
  while (at < text.size() && !isBlank(at) && text[at] != '>' && !(text[at] == '/' && at > begin + 1))
    tag.name += text[at++];
  while (at < text.size() && text[at] != '>') {
    std::string name;
    while (at < text.size() && (isBlank(at) || text[at] == '/')) {
      tag.isEmpty = text[at] == '/';
      ++at;
    }
    while (at < text.size() && text[at] != '=' && text[at] != '>')
      name += text[at++];
    if (at >= text.size() || text[at] == '>')
      break;
    const char quote = ++at < text.size() ? text[at] : '"';
    const std::size_t end = text.find(quote, at + 1);
    if (end == std::string::npos)
      break;
    tag.attributes[name] = text.substr(at + 1, end - at - 1);
    at = end + 1;
    tag.isEmpty = at < text.size() && text[at] == '/';
  }
  tag.end = std::min(at + 1, text.size());
  return tag;
}

std::string bytesFromBase64(const std::string& text, std::size_t begin, std::size_t end, std::size_t most,
                            std::size_t& next) {
  std::string bytes;
  unsigned int bits = 0;
  int held = 0;
  next = begin;
  for (; next < end && bytes.size() < most; ++next) {
    const char c = text[next];
    const int value = c >= 'A' && c <= 'Z'   ? c - 'A'
                      : c >= 'a' && c <= 'z' ? c - 'a' + 26
                      : c >= '0' && c <= '9' ? c - '0' + 52
                      : c == '+'             ? 62
                      : c == '/'             ? 63
                                             : -1;
    if (value < 0)
      continue; // blanks, and what fills up the last four
    bits = (bits << 6U) | static_cast<unsigned int>(value);
    held += 6;
    if (held >= 8) {
      held -= 8;
      bytes += static_cast<char>((bits >> static_cast<unsigned int>(held)) & 0xffU);
    }
  }
  while (next < end && text[next] == '=')
    ++next;
  return bytes;
}

class VtuReader {
 public:
  VtuReader(const std::string& path, const std::string& text) : path_(path), text_(text) {}

  VtkGrid read() {
    const std::size_t appended = text_.find("<AppendedData");
    findAppended(appended);
    const std::size_t end = std::min(appended, text_.size());
    std::string section;
    for (std::size_t at = text_.find('<'); at < end; at = text_.find('<', at)) {
      const Tag tag = tagAt(text_, at);
      at = tag.end;
      if (tag.name == "VTKFile")
        header(tag);
      else if (tag.name == "Piece")
        piece(tag);
      else if (tag.name == "Points" || tag.name == "Cells" || tag.name == "CellData" ||
               tag.name == "PointData")
        section = tag.name;
      else if (tag.name == "DataArray")
        array(section, tag);
    }
    if (pieces_ != 1)
      failVtu(path_, "it holds " + std::to_string(pieces_) +
                         " pieces, where one is read; in ParaView, Merge Blocks or " +
                         "Append Datasets makes one of them");
    return std::move(grid_);
  }

 private:
  void header(const Tag& tag) {
    if (tag.get("type") != "UnstructuredGrid")
      failVtu(
          path_,
          "it holds a data set of the kind \"" + tag.get("type") +
              "\", but bodies are made of an UnstructuredGrid; in ParaView, Append Datasets makes one of it");
    const std::string compressor = tag.get("compressor");
    isCompressed_ = !compressor.empty();
    if (isCompressed_ && compressor != "vtkZLibDataCompressor")
      failVtu(path_,
              "it uses the unsupported compressor " + compressor + "; save it with zlib or uncompressed");
    headerType_ = tag.get("header_type", "UInt32");
    const unsigned int one = 1;
    const bool isLittle = *reinterpret_cast<const char*>(&one) == 1;
    isSwapped_ = (tag.get("byte_order", "LittleEndian") == "LittleEndian") != isLittle;
  }

  void piece(const Tag& tag) {
    ++pieces_;
    points_ = count(tag, "NumberOfPoints");
    cells_ = count(tag, "NumberOfCells");
  }

  std::size_t count(const Tag& tag, const std::string& name) const {
    const std::string text = tag.get(name);
    char* end = nullptr;
    const unsigned long long value = std::strtoull(text.c_str(), &end, 10);
    if (text.empty() || *end != '\0')
      failVtu(path_, "a <" + tag.name + "> has no number \"" + name + "\"");
    return static_cast<std::size_t>(value);
  }

  void findAppended(std::size_t begin) {
    if (begin >= text_.size())
      return;
    const Tag tag = tagAt(text_, begin);
    isRaw_ = tag.get("encoding", "base64") == "raw";
    appended_ = text_.find('_', tag.end) + 1;
    if (appended_ == 0)
      failVtu(path_, "its appended data do not begin with \"_\"");
  }

  void array(const std::string& section, const Tag& tag) {
    const std::string name = tag.get("Name"), type = tag.get("type");
    const bool isOfCells = section == "CellData";
    const std::string components = tag.get("NumberOfComponents", "1");
    if (section == "Points") {
      grid_.points = reals(tag, type, 3 * points_);
    } else if (section == "Cells" && name == "offsets") {
      grid_.offsets = integers(tag, type, cells_);
    } else if (section == "Cells" && name == "types") {
      for (long long value : integers(tag, type, cells_))
        grid_.types.push_back(static_cast<int>(value));
    } else if (section == "Cells" && name == "connectivity") {
      grid_.nodes = integers(tag, type, everything);
    } else if (isOfCells && components == "1" && Details::isIntegral(type)) {
      grid_.data[name] = integers(tag, type, cells_);
    }
  }

  // As many as there are.
  static constexpr std::size_t everything = static_cast<std::size_t>(-1);

  std::vector<double> reals(const Tag& tag, const std::string& type, std::size_t number) const {
    if (tag.get("format", "ascii") == "ascii")
      return words<double>(tag, number);
    const std::string bytes = bytesOf(tag);
    return Details::realsOf(path_, bytes.data(), bytes.size(), type, number, isSwapped_);
  }

  std::vector<long long> integers(const Tag& tag, const std::string& type, std::size_t number) const {
    if (tag.get("format", "ascii") == "ascii")
      return words<long long>(tag, number);
    const std::string bytes = bytesOf(tag);
    if (number == everything)
      number = bytes.size() / Details::bytesOf(path_, type);
    return Details::integersOf(path_, bytes.data(), bytes.size(), type, number, isSwapped_);
  }

  template<class Number>
  std::vector<Number> words(const Tag& tag, std::size_t number) const {
    const std::size_t end = tag.isEmpty ? tag.end : std::min(text_.find('<', tag.end), text_.size());
    std::istringstream stream(text_.substr(tag.end, end - tag.end));
    std::vector<Number> values;
    for (Number value; values.size() < number && stream >> value;)
      values.push_back(value);
    if (number != everything && values.size() < number)
      failVtu(path_, "the array \"" + tag.get("Name") + "\" has " + std::to_string(values.size()) +
                         " numbers where " + std::to_string(number) + " were expected");
    return values;
  }

  // What an array holds, decoded and inflated.
  std::string bytesOf(const Tag& tag) const {
    const bool isAppended = tag.get("format") == "appended";
    std::size_t at = tag.end,
                end = isAppended ? text_.size() : std::min(text_.find('<', tag.end), text_.size());
    if (isAppended)
      at = appended_ + count(tag, "offset");
    if (at > end)
      failVtu(path_, "it is truncated or damaged");
    const bool isPlain = isAppended && isRaw_;
    const auto take = [&](std::size_t size) {
      std::string bytes;
      if (isPlain) {
        bytes = text_.substr(at, std::min(size, end - at));
        at += bytes.size();
      } else {
        bytes = bytesFromBase64(text_, at, end, size, at);
      }
      if (bytes.size() < size)
        failVtu(path_, "it is truncated or damaged");
      return bytes;
    };
    const std::size_t word = Details::bytesOf(path_, headerType_);
    if (!isCompressed_) {
      // Base64 goes on from the length to the data without filling up.
      const std::size_t start = at;
      const std::size_t size = lengths(take(word), 1)[0];
      if (isPlain)
        return take(size);
      at = start;
      checkSize(size);
      return take(word + size).substr(word);
    }
    return inflated(take, word);
  }

  template<class Take>
  std::string inflated(const Take& take, std::size_t word) const {
    // Number of blocks, size of one, size of the last; then what each is compressed to. The header is encoded
    // by itself, and three words end where base64 ends a group of four.
    const std::vector<std::size_t> head = lengths(take(3 * word), 3);
    const std::size_t blocks = head[0];
    checkSize(blocks);
    const std::vector<std::size_t> sizes = lengths(take(blocks * word), blocks);
    std::size_t all = 0;
    for (std::size_t size : sizes) {
      checkSize(size);
      all += size;
    }
    checkSize(all);
    const std::string packed = take(all);
    std::string bytes;
    std::size_t at = 0;
    for (std::size_t k = 0; k < blocks; ++k) {
      bytes += unpacked(packed.data() + at, sizes[k], k + 1 == blocks && head[2] > 0 ? head[2] : head[1]);
      at += sizes[k];
    }
    return bytes;
  }

  std::string unpacked(const char* packed, std::size_t packedSize, std::size_t size) const {
    constexpr std::size_t closest = 1100; // zlib packs no closer than 1032 to one
    if (size > closest * (packedSize + 1))
      failVtu(path_, "it is truncated or damaged");
    std::string block(size, '\0');
    auto length = static_cast<uLongf>(size);
    const int status = uncompress(reinterpret_cast<Bytef*>(block.data()), &length,
                                  reinterpret_cast<const Bytef*>(packed), static_cast<uLong>(packedSize));
    if (status != Z_OK || length != size)
      failVtu(path_, "its compressed data are damaged");
    return block;
  }

  std::vector<std::size_t> lengths(const std::string& bytes, std::size_t number) const {
    std::vector<std::size_t> result;
    for (long long value :
         Details::integersOf(path_, bytes.data(), bytes.size(), headerType_, number, isSwapped_))
      result.push_back(static_cast<std::size_t>(value));
    return result;
  }

  void checkSize(std::size_t size) const {
    if (size > text_.size())
      failVtu(path_, "it is truncated or damaged");
  }

  const std::string& path_;
  const std::string& text_;
  std::string headerType_ = "UInt32";
  bool isCompressed_ = false, isSwapped_ = false, isRaw_ = false;
  std::size_t appended_ = 0, points_ = 0, cells_ = 0;
  int pieces_ = 0;
  VtkGrid grid_;
};

} // namespace

VtkGrid Details::readVtu(const std::string& path, const std::string& text) {
  return VtuReader(path, text).read();
}

} // namespace Harmos::fem
