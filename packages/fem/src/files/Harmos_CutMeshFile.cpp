// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CutMeshFile.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Hdf5.hpp"
#include "Harmos_TornBody.hpp"

#include <filesystem>
#include <numeric>
#include <sstream>

namespace Harmos::fem {
namespace {

constexpr const char* format = "Harmos cut mesh 1\n";
constexpr const char* fileKind = "the mesh file";

using Bytes = std::vector<unsigned char>;

Bytes linesOf(const std::vector<std::string>& names) {
  Bytes bytes;
  for (const std::string& name : names) {
    bytes.insert(bytes.end(), name.begin(), name.end());
    bytes.push_back('\n');
  }
  return bytes;
}

std::vector<std::string> namesIn(const Bytes& bytes) {
  std::istringstream text(std::string(bytes.begin(), bytes.end()));
  std::vector<std::string> names;
  for (std::string line; std::getline(text, line);)
    names.push_back(line);
  return names;
}

// FNV-1a (Fowler, Noll, Vo) of 64 bits.
long long checkOf(const PlacedMesh& mesh) {
  unsigned long long hash = 14695981039346656037ull;
  for (char byte : pack(mesh)) {
    hash ^= static_cast<unsigned char>(byte);
    hash *= 1099511628211ull;
  }
  return static_cast<long long>(hash);
}

std::string placeOf(std::size_t body) {
  return "/body_" + std::to_string(body);
}

// Rows of all subdomains, one after the other; where those of each begin.
template<class T>
struct Column {
  std::vector<T> rows;
  std::vector<long long> begin = {0};

  void add(const std::vector<T>& more, std::size_t width = 1) {
    rows.insert(rows.end(), more.begin(), more.end());
    begin.push_back(static_cast<long long>(rows.size() / width));
  }
};

template<class T>
std::vector<T> namedOrNone(const std::map<std::string, std::vector<T>>& all, const std::string& name) {
  const auto found = all.find(name);
  return found == all.end() ? std::vector<T>() : found->second;
}

std::vector<int> flat(const std::vector<Side>& sides) {
  std::vector<int> numbers;
  for (const Side& side : sides) {
    numbers.push_back(side.cell);
    numbers.push_back(side.side);
  }
  return numbers;
}

// A dataset, written by the one process that there is.
class Writer {
 public:
  Writer(const Teuchos::Comm<int>& comm, const std::string& path, long long bytes)
      : file_(comm, path, fileKind, bytes) {}

  template<class T>
  void write(const std::string& path, const std::vector<T>& values, std::size_t width = 1) {
    file_.rows(path, values, width, 0, static_cast<long long>(values.size() / width));
  }
  void group(const std::string& path) { file_.group(path); }
  void commit() { file_.commit(); }

 private:
  io::Hdf5Writer file_;
};

std::vector<std::string> partsOf(const CutBody& body) {
  std::vector<std::string> names;
  for (const PlacedMesh& mesh : body.subdomains) {
    for (const auto& set : mesh.sets)
      names.push_back(set.first);
    for (const auto& sides : mesh.sides)
      names.push_back(sides.first);
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

void writeParts(const CutBody& body, const std::string& place, Writer& file) {
  const std::vector<std::string> names = partsOf(body);
  file.write(place + "/parts", linesOf(names));
  for (std::size_t p = 0; p < names.size(); ++p) {
    Column<int> nodes, sides;
    for (const PlacedMesh& mesh : body.subdomains) {
      nodes.add(namedOrNone(mesh.sets, names[p]));
      sides.add(flat(namedOrNone(mesh.sides, names[p])), 2);
    }
    const std::string part = place + "/part_" + std::to_string(p);
    file.group(part);
    std::vector<long long> begin;
    for (std::size_t s = 0; s < nodes.begin.size(); ++s) {
      begin.push_back(nodes.begin[s]);
      begin.push_back(sides.begin[s]);
    }
    file.write(part + "/begin", begin, 2);
    file.write(part + "/nodes", nodes.rows);
    file.write(part + "/sides", sides.rows, 2);
  }
}

// Of all nodes, in the order of the coordinates. A file without fields is one of before there were any.
void writeFields(const CutBody& body, const std::string& place, Writer& file) {
  std::vector<std::string> names;
  for (const auto& field : body.subdomains.front().fields)
    names.push_back(field.first);
  if (names.empty())
    return;
  file.write(place + "/fields", linesOf(names));
  for (std::size_t f = 0; f < names.size(); ++f) {
    Column<double> values;
    for (const PlacedMesh& mesh : body.subdomains)
      values.add(mesh.fields.at(names[f]));
    file.write(place + "/field_" + std::to_string(f), values.rows);
  }
}

void writeBody(const CutBody& body, const std::string& place, Writer& file) {
  file.group(place);
  const CellShape& shape = shapeOf(body.cellType);
  const auto dimension = static_cast<std::size_t>(shape.dimension),
             width = static_cast<std::size_t>(shape.nodes);
  Column<double> coordinates;
  Column<int> cellNodes, regions, boundary;
  std::vector<long long> numbers, check;
  std::vector<double> anchors;
  for (const PlacedMesh& placed : body.subdomains) {
    const Mesh& mesh = *placed.mesh;
    HARMOS_REQUIRE(mesh.cellType == body.cellType, "a body has cells of one type");
    coordinates.add(mesh.coordinates, dimension);
    cellNodes.add(mesh.cells, width);
    regions.add(mesh.regions);
    boundary.add(mesh.boundary);
    numbers.insert(numbers.end(), placed.boundaryNumbers.begin(), placed.boundaryNumbers.end());
    anchors.insert(anchors.end(), placed.anchor.begin(), placed.anchor.end());
    check.push_back(checkOf(placed));
  }
  std::vector<long long> begin;
  for (std::size_t s = 0; s < coordinates.begin.size(); ++s)
    for (long long row : {coordinates.begin[s], cellNodes.begin[s], boundary.begin[s]})
      begin.push_back(row);
  file.write(place + "/type", linesOf({shape.name}));
  file.write(place + "/regions", linesOf(body.regions));
  file.write(place + "/nodes", std::vector<long long>{body.nodes});
  file.write(place + "/begin", begin, 3);
  file.write(place + "/check", check);
  file.write(place + "/anchor", anchors, 3);
  file.write(place + "/coordinates", coordinates.rows, dimension);
  file.write(place + "/cells", cellNodes.rows, width);
  file.write(place + "/cell_regions", regions.rows);
  file.write(place + "/boundary", boundary.rows);
  file.write(place + "/boundary_numbers", numbers);
  writeFields(body, place, file);
  writeParts(body, place, file);
}

long long bytesOf(const std::vector<CutBody>& bodies) {
  long long bytes = 0;
  for (const CutBody& body : bodies)
    for (const PlacedMesh& mesh : body.subdomains)
      bytes += static_cast<long long>(pack(mesh).size()) + 1024;
  return bytes;
}

} // namespace

void writeCutMesh(const Teuchos::Comm<int>& comm, const std::string& path,
                  const std::vector<CutBody>& bodies) {
  HARMOS_REQUIRE(comm.getSize() == 1, "a mesh is cut by one process");
  Writer file(comm, path, bytesOf(bodies));
  std::vector<std::string> names;
  for (const CutBody& body : bodies)
    names.push_back(body.name);
  file.write("/format", linesOf({std::string(format, std::string(format).size() - 1)}));
  file.write("/bodies", linesOf(names));
  for (std::size_t k = 0; k < bodies.size(); ++k)
    writeBody(bodies[k], placeOf(k), file);
  file.commit();
}

struct CutMeshFile::File {
  io::Hdf5Reader reader;
  std::vector<std::vector<std::string>> parts, fields; // of each body

  explicit File(const std::string& path) : reader(path, fileKind) {}

  std::vector<std::string> names(const std::string& path) const {
    return namesIn(reader.all<unsigned char>(path));
  }
};

bool CutMeshFile::isOne(const std::string& path) {
  return std::filesystem::path(path).extension() == ".h5";
}

CutMeshFile::CutMeshFile(const std::string& path) : path_(path) {
  std::error_code failure;
  if (!std::filesystem::exists(path, failure))
    throw InputError("mesh file not found: \"" + path + "\"; check the path or write it with harmos-mesh");
  file_ = std::make_unique<File>(path);
  const auto fail = [&](const std::string& reason) {
    throw InputError("the mesh file \"" + path + "\" " + reason + "; write it again with harmos-mesh",
                     {{"file", path}});
  };
  if (!file_->reader.has("/format") ||
      linesOf(file_->names("/format")) != Bytes(format, format + std::string(format).size()))
    fail("was not written by this version of harmos-mesh");
  for (const std::string& name : file_->names("/bodies")) {
    const std::string place = placeOf(bodies_.size());
    Body body;
    body.name = name;
    const std::vector<std::string> type = file_->names(place + "/type");
    const auto cell = std::find_if(bodyCells.begin(), bodyCells.end(), [&](CellType c) {
      return type.size() == 1 && shapeOf(c).name == type[0];
    });
    const std::vector<long long> nodes = file_->reader.all<long long>(place + "/nodes");
    const io::Hdf5Reader::Shape begin = file_->reader.shape(place + "/begin");
    if (cell == bodyCells.end() || nodes.size() != 1 || begin.width != 3 || begin.rows < 2)
      fail("is damaged: body \"" + name + "\" has no cells, nodes or subdomains");
    body.cellType = *cell;
    body.nodes = nodes[0];
    body.subdomains = static_cast<int>(begin.rows - 1);
    body.regions = file_->names(place + "/regions");
    bodies_.push_back(body);
    file_->parts.push_back(file_->names(place + "/parts"));
    file_->fields.emplace_back();
    if (file_->reader.has(place + "/fields"))
      file_->fields.back() = file_->names(place + "/fields");
  }
}

CutMeshFile::~CutMeshFile() = default;

PlacedMesh CutMeshFile::subdomain(std::size_t body, int number, long long firstNode) const {
  const std::string place = placeOf(body);
  const io::Hdf5Reader& file = file_->reader;
  const std::vector<long long> begin = file.rows<long long>(place + "/begin", number, 2);
  const auto rows = [&](auto example, const std::string& name, std::size_t column) {
    return file.rows<decltype(example)>(place + name, begin[column], begin[3 + column] - begin[column]);
  };
  auto mesh = std::make_shared<Mesh>();
  mesh->cellType = bodies_[body].cellType;
  mesh->coordinates = rows(0.0, "/coordinates", 0);
  mesh->cells = rows(0, "/cells", 1);
  if (file.shape(place + "/cell_regions").rows > 0)
    mesh->regions = rows(0, "/cell_regions", 1);
  mesh->boundary = rows(0, "/boundary", 2);
  PlacedMesh placed;
  placed.boundaryNumbers = rows(0LL, "/boundary_numbers", 2);
  const std::vector<double> anchor = file.rows<double>(place + "/anchor", number, 1);
  std::copy_n(anchor.begin(), std::min<std::size_t>(3, anchor.size()), placed.anchor.begin());
  const std::vector<std::string>& parts = file_->parts[body];
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const std::string part = place + "/part_" + std::to_string(p);
    const std::vector<long long> from = file.rows<long long>(part + "/begin", number, 2);
    const std::vector<int> nodes = file.rows<int>(part + "/nodes", from[0], from[2] - from[0]);
    const std::vector<int> sides = file.rows<int>(part + "/sides", from[1], from[3] - from[1]);
    if (!nodes.empty())
      placed.sets[parts[p]] = nodes;
    for (std::size_t k = 0; k + 1 < sides.size(); k += 2)
      placed.sides[parts[p]].push_back({sides[k], sides[k + 1]});
  }
  for (std::size_t f = 0; f < file_->fields[body].size(); ++f)
    placed.fields[file_->fields[body][f]] = rows(0.0, "/field_" + std::to_string(f), 0);
  placed.mesh = mesh;
  if (checkOf(placed) != file.rows<long long>(place + "/check", number, 1).front())
    throw InputError("the mesh file \"" + path_ + "\" is damaged: subdomain " + std::to_string(number) +
                         " of body \"" + bodies_[body].name +
                         "\" has a wrong checksum; write it again with harmos-mesh",
                     {{"file", path_}, {"body", bodies_[body].name}});
  for (long long& node : placed.boundaryNumbers)
    node += firstNode;
  return placed;
}

} // namespace Harmos::fem
