// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_TornBody.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Index.hpp"

#include <cstring>
#include <type_traits>

namespace Harmos::fem {
namespace {

void makeSet(std::vector<int>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

// Appends values to bytes.
class Writer {
 public:
  template<class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>, "values travel as bytes");
    putBytes(&value, sizeof(T));
  }
  template<class T>
  void putAll(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>, "values travel as bytes");
    put(values.size());
    putBytes(values.data(), values.size() * sizeof(T));
  }
  template<class T>
  void putNamed(const std::map<std::string, std::vector<T>>& named) {
    put(named.size());
    for (const auto& [name, values] : named) {
      put(name.size());
      putBytes(name.data(), name.size());
      putAll(values);
    }
  }
  std::vector<char> take() { return std::move(bytes_); }

 private:
  void putBytes(const void* data, std::size_t size) {
    const char* begin = static_cast<const char*>(data);
    bytes_.insert(bytes_.end(), begin, begin + size);
  }

  std::vector<char> bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(const std::vector<char>& bytes) : bytes_(bytes) {}

  template<class T>
  T get() {
    T value;
    std::memcpy(&value, next(sizeof(T)), sizeof(T));
    return value;
  }
  template<class T>
  std::vector<T> getAll() {
    const auto size = get<std::size_t>();
    HARMOS_REQUIRE(size <= left() / sizeof(T), "the bytes of a mesh end too early");
    std::vector<T> values(size);
    if (size > 0)
      std::memcpy(values.data(), next(size * sizeof(T)), size * sizeof(T));
    return values;
  }
  template<class T>
  std::map<std::string, std::vector<T>> getNamed() {
    std::map<std::string, std::vector<T>> named;
    for (auto count = get<std::size_t>(); count > 0; --count) {
      const auto size = get<std::size_t>();
      const std::string name(next(size), size);
      named[name] = getAll<T>();
    }
    return named;
  }
  std::size_t left() const { return bytes_.size() - place_; }

 private:
  const char* next(std::size_t size) {
    HARMOS_REQUIRE(size <= left(), "the bytes of a mesh end too early");
    const char* result = bytes_.data() + place_;
    place_ += size;
    return result;
  }

  const std::vector<char>& bytes_;
  std::size_t place_ = 0;
};

// The subdomains that leave the first rank, as one row of bytes for each other rank: size and content, one
// after the other. A subdomain is packed when its turn comes, so that one at a time is held twice.
class Outbox {
 public:
  Outbox(const std::vector<PlacedMesh>& meshes, const std::vector<int>& owner)
      : meshes_(meshes), owner_(owner) {
    skipOwn();
  }

  bool isEmpty() const { return next_ == owner_.size(); }

  std::vector<std::vector<char>> round(std::size_t ranks, std::size_t most) {
    std::vector<std::vector<char>> sends(ranks);
    while (!isEmpty() && most > 0) {
      if (bytes_.empty()) {
        const std::vector<char> content = pack(meshes_[next_]);
        const std::size_t size = content.size();
        bytes_.resize(sizeof(size));
        std::memcpy(bytes_.data(), &size, sizeof(size));
        bytes_.insert(bytes_.end(), content.begin(), content.end());
      }
      const std::size_t count = std::min(most, bytes_.size() - sent_);
      const char* begin = bytes_.data() + sent_;
      std::vector<char>& send = sends[at(owner_[next_])];
      send.insert(send.end(), begin, begin + count);
      sent_ += count;
      most -= count;
      if (sent_ == bytes_.size()) {
        bytes_.clear();
        sent_ = 0;
        ++next_;
        skipOwn();
      }
    }
    return sends;
  }

 private:
  void skipOwn() {
    while (next_ < owner_.size() && owner_[next_] == 0)
      ++next_;
  }

  const std::vector<PlacedMesh>& meshes_;
  const std::vector<int>& owner_;
  std::size_t next_ = 0;
  std::vector<char> bytes_; // of the next one
  std::size_t sent_ = 0;    // of these
};

// Unpacks the meshes that have arrived as a whole, and keeps the rest.
void unpackWhole(std::vector<char>& bytes, std::vector<PlacedMesh>& meshes) {
  std::size_t done = 0, size = 0;
  while (bytes.size() - done >= sizeof(size)) {
    std::memcpy(&size, bytes.data() + done, sizeof(size));
    if (bytes.size() - done - sizeof(size) < size)
      break;
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(done + sizeof(size));
    meshes.push_back(unpack(std::vector<char>(begin, begin + static_cast<std::ptrdiff_t>(size))));
    done += sizeof(size) + size;
  }
  bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(done));
}

} // namespace

namespace {

// A node in a part.
struct NodeCopy {
  int part, number; // the latter among the part's
};

// Cells and nodes of the parts of a body.
class Parts {
 public:
  Parts(const Mesh& whole, const std::vector<int>& part, int parts)
      : whole_(whole), part_(part), cells_(at(parts)), nodes_(at(parts)), cellNumber_(part.size()) {
    for (int c = 0; c < whole.numberOfCells(); ++c) {
      HARMOS_REQUIRE(part[at(c)] >= 0 && part[at(c)] < parts, "there is no such part");
      std::vector<int>& own = cells_[at(part[at(c)])];
      cellNumber_[at(c)] = static_cast<int>(own.size());
      own.push_back(c);
    }
    findNodes();
    countCopies();
  }

  std::size_t count() const { return cells_.size(); }
  const std::vector<int>& cells(std::size_t p) const { return cells_[p]; }
  const std::vector<int>& nodes(std::size_t p) const { return nodes_[p]; } // of the body, rising
  int cellNumber(int cell) const { return cellNumber_[at(cell)]; }

  const NodeCopy* begin(int node) const { return copies_.data() + first_[at(node)]; }
  const NodeCopy* end(int node) const { return copies_.data() + first_[at(node) + 1]; }

  // By part: whether each of its nodes is on the boundary of the part, or of those that are marked.
  std::vector<std::vector<char>> boundaries(const MatchedSides& matched,
                                            const std::vector<char>& isMarked) const {
    std::vector<std::vector<char>> isOn;
    for (const std::vector<int>& nodes : nodes_)
      isOn.emplace_back(nodes.size(), 0);
    for (int node = 0; node < whole_.numberOfNodes(); ++node)
      if (isMarked[at(node)] || end(node) - begin(node) > 1)
        for (const NodeCopy* copy = begin(node); copy != end(node); ++copy)
          isOn[at(copy->part)][at(copy->number)] = 1;
    // Nodes of sides between parts have several copies; what is left are sides of one cell.
    const std::vector<std::vector<int>>& sides = shapeOf(whole_.cellType).sides;
    for (std::size_t group = 0; group + 1 < matched.first.size(); ++group) {
      if (matched.first[group + 1] > matched.first[group] + 1)
        continue;
      const Side& side = matched.sides[matched.first[group]];
      for (int corner : sides[at(side.side)])
        for (const NodeCopy* copy = begin(whole_.cell(side.cell)[corner]);
             copy != end(whole_.cell(side.cell)[corner]); ++copy)
          if (copy->part == part_[at(side.cell)])
            isOn[at(copy->part)][at(copy->number)] = 1;
    }
    return isOn;
  }

 private:
  void findNodes() {
    std::vector<int> seen(at(whole_.numberOfNodes()), -1); // the last part with a node
    for (std::size_t p = 0; p < cells_.size(); ++p) {
      HARMOS_REQUIRE(!cells_[p].empty(), "a part without cells cannot be a subdomain");
      for (int c : cells_[p])
        for (int i = 0; i < whole_.nodesPerCell(); ++i)
          if (const int node = whole_.cell(c)[i]; seen[at(node)] != static_cast<int>(p)) {
            seen[at(node)] = static_cast<int>(p);
            nodes_[p].push_back(node);
          }
      std::sort(nodes_[p].begin(), nodes_[p].end());
    }
  }

  void countCopies() {
    first_.assign(at(whole_.numberOfNodes()) + 1, 0);
    for (const std::vector<int>& nodes : nodes_)
      for (int node : nodes)
        ++first_[at(node) + 1];
    for (std::size_t k = 1; k < first_.size(); ++k)
      first_[k] += first_[k - 1];
    copies_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t p = 0; p < nodes_.size(); ++p)
      for (std::size_t k = 0; k < nodes_[p].size(); ++k)
        copies_[next[at(nodes_[p][k])]++] = {static_cast<int>(p), static_cast<int>(k)};
  }

  const Mesh& whole_;
  const std::vector<int>& part_;
  std::vector<std::vector<int>> cells_, nodes_;
  std::vector<int> cellNumber_;    // of each cell in its part
  std::vector<std::size_t> first_; // copy of each node
  std::vector<NodeCopy> copies_;   // by node and part
};

// The mesh of a part, without its boundary. @param number receives its nodes' numbers by those of the body.
std::shared_ptr<Mesh> meshOf(const Mesh& whole, const std::vector<int>& cells, const std::vector<int>& nodes,
                             const Point& anchor, std::vector<int>& number) {
  const auto nodesPerCell = at(whole.nodesPerCell());
  const auto dimension = at(whole.dimension());
  auto mesh = std::make_shared<Mesh>();
  mesh->cellType = whole.cellType;
  mesh->coordinates.reserve(nodes.size() * dimension);
  mesh->cells.reserve(cells.size() * nodesPerCell);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    number[at(nodes[k])] = static_cast<int>(k);
    for (std::size_t d = 0; d < dimension; ++d)
      mesh->coordinates.push_back(whole.coordinates[at(nodes[k]) * dimension + d] - anchor[d]);
  }
  for (int c : cells) {
    for (std::size_t i = 0; i < nodesPerCell; ++i)
      mesh->cells.push_back(number[at(whole.cell(c)[i])]);
    if (!whole.regions.empty())
      mesh->regions.push_back(whole.regions[at(c)]);
  }
  return mesh;
}

} // namespace

std::vector<PlacedMesh> tear(const BodyMesh& body, const std::vector<int>& part, int parts,
                             long long firstNode) {
  const Mesh& whole = body.mesh;
  HARMOS_REQUIRE(static_cast<int>(part.size()) == whole.numberOfCells(), "each cell needs a part");
  const Parts torn(whole, part, parts);
  std::map<std::string, std::vector<int>> sets = body.nodes; // nodes of the body
  std::vector<char> isNamed(at(whole.numberOfNodes()), 0);
  for (const auto& [name, sides] : body.sides) {
    const std::vector<int> more = nodesOf(whole, sides);
    sets[name].insert(sets[name].end(), more.begin(), more.end());
  }
  for (auto& [name, set] : sets) {
    makeSet(set);
    for (int node : set)
      isNamed[at(node)] = 1;
  }
  const std::vector<std::vector<char>> isOnBoundary =
      body.matched ? torn.boundaries(*body.matched, isNamed) : torn.boundaries(matchSides(whole), isNamed);

  std::vector<PlacedMesh> result(torn.count());
  std::vector<int> number(isNamed.size(), -1);
  for (std::size_t p = 0; p < result.size(); ++p) {
    PlacedMesh& placed = result[p];
    const std::vector<int>& nodes = torn.nodes(p);
    placed.anchor = whole.local(nodes.front());
    const std::shared_ptr<Mesh> mesh = meshOf(whole, torn.cells(p), nodes, placed.anchor, number);
    for (const auto& [name, values] : body.fields)
      for (int node : nodes)
        placed.fields[name].push_back(values[at(node)]);
    for (std::size_t k = 0; k < nodes.size(); ++k)
      if (isOnBoundary[p][k]) {
        mesh->boundary.push_back(static_cast<int>(k));
        placed.boundaryNumbers.push_back(firstNode + body.number(nodes[k]));
      }
    placed.mesh = mesh;
  }
  for (const auto& [name, set] : sets)
    for (int node : set)
      for (const NodeCopy* copy = torn.begin(node); copy != torn.end(node); ++copy)
        result[at(copy->part)].sets[name].push_back(copy->number); // in order: numbers rise with the body's
  for (const auto& [name, sides] : body.sides)
    for (const Side& side : sides)
      result[at(part[at(side.cell)])].sides[name].push_back({torn.cellNumber(side.cell), side.side});
  return result;
}

std::vector<char> pack(const PlacedMesh& placed) {
  const Mesh& mesh = *placed.mesh;
  Writer writer;
  writer.put(mesh.cellType);
  writer.putAll(mesh.coordinates);
  writer.putAll(mesh.cells);
  writer.putAll(mesh.boundary);
  writer.putAll(mesh.regions);
  writer.put(placed.anchor);
  writer.putAll(placed.boundaryNumbers);
  writer.putNamed(placed.sets);
  writer.putNamed(placed.sides);
  if (!placed.fields.empty())
    writer.putNamed(placed.fields);
  return writer.take();
}

PlacedMesh unpack(const std::vector<char>& bytes) {
  ByteReader reader(bytes);
  auto mesh = std::make_shared<Mesh>();
  mesh->cellType = reader.get<CellType>();
  mesh->coordinates = reader.getAll<double>();
  mesh->cells = reader.getAll<int>();
  mesh->boundary = reader.getAll<int>();
  mesh->regions = reader.getAll<int>();
  PlacedMesh placed;
  placed.mesh = mesh;
  placed.anchor = reader.get<Point>();
  placed.boundaryNumbers = reader.getAll<long long>();
  placed.sets = reader.getNamed<int>();
  placed.sides = reader.getNamed<Side>();
  if (reader.left() > 0)
    placed.fields = reader.getNamed<double>();
  HARMOS_REQUIRE(reader.left() == 0, "the bytes of a mesh are more than the mesh");
  return placed;
}

std::vector<PlacedMesh> distribute(const Teuchos::Comm<int>& comm, const std::vector<PlacedMesh>& onRoot,
                                   const std::vector<int>& owner, std::size_t bytesPerRound) {
  const bool isRoot = comm.getRank() == 0;
  const auto ranks = at(comm.getSize());
  agree(comm, [&] {
    HARMOS_REQUIRE(bytesPerRound > 0, "a round has to carry something");
    HARMOS_REQUIRE(!isRoot || onRoot.size() == owner.size(), "each subdomain needs an owner");
    for (int rank : owner)
      HARMOS_REQUIRE(rank >= 0 && at(rank) < ranks, "an owner is no rank of the communicator");
  });
  std::vector<PlacedMesh> mine;
  if (isRoot)
    for (std::size_t s = 0; s < owner.size(); ++s)
      if (owner[s] == 0)
        mine.push_back(onRoot[s]);
  Outbox outbox(onRoot, owner);
  std::vector<char> arrived;
  while (globalMax(comm, static_cast<long long>(isRoot && !outbox.isEmpty())) > 0) {
    std::vector<std::vector<char>> sends(ranks);
    agree(comm, [&] {
      if (isRoot)
        sends = outbox.round(ranks, bytesPerRound);
    });
    const std::vector<std::vector<char>> received = exchangeItems(comm, sends);
    agree(comm, [&] {
      if (isRoot)
        return;
      arrived.insert(arrived.end(), received.front().begin(), received.front().end());
      unpackWhole(arrived, mine);
    });
  }
  agree(comm, [&] {
    HARMOS_REQUIRE(arrived.empty() && static_cast<std::ptrdiff_t>(mine.size()) ==
                                          std::count(owner.begin(), owner.end(), comm.getRank()),
                   "a rank did not get the subdomains it owns");
  });
  return mine;
}

} // namespace Harmos::fem
