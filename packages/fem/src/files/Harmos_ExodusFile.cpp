// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ExodusFile.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#ifdef HARMOS_HAVE_EXODUS

#include "Harmos_Index.hpp"
#include "Harmos_NetcdfHeader.hpp"

#include <exodusII.h>

#include <cstdint>
#include <limits>
#include <numeric>

namespace Harmos::fem {
namespace {

struct Topology {
  const char* head; // of the names that files give it
  int corners;
  std::vector<CellType> types;
};

const std::vector<Topology>& topologies() {
  static const std::vector<Topology> known = {
      {"TRI", 3, {CellType::Triangle3, CellType::Triangle6}},
      {"QUAD", 4, {CellType::Quadrilateral4, CellType::Quadrilateral8, CellType::Quadrilateral9}},
      {"TET", 4, {CellType::Tetrahedron4, CellType::Tetrahedron10}},
      {"WEDGE", 6, {CellType::Wedge6, CellType::Wedge15, CellType::Wedge18}},
      {"HEX", 8, {CellType::Hexahedron8, CellType::Hexahedron20, CellType::Hexahedron27}}};
  return known;
}

/// A file of Exodus, open.
class File {
 public:
  explicit File(const std::string& path) : path_(path) {
    if (!Details::isSoundNetcdf(path))
      throw InputError("\"" + path + "\" cannot be read: its header is damaged");
    ex_opts(0); // errors are told by status alone
    int ours = sizeof(double), stored = 0;
    float version = 0.0F;
    id_ = ex_open(path.c_str(), EX_READ, &ours, &stored, &version);
    if (id_ < 0)
      throw InputError("\"" + path + "\" cannot be read: it is no file of Exodus II, or is damaged");
    ex_set_int64_status(id_, EX_ALL_INT64_API);
    ex_set_max_name_length(id_, static_cast<int>(std::max<std::int64_t>(
                                    32, ex_inquire_int(id_, EX_INQ_DB_MAX_USED_NAME_LENGTH))));
  }
  ~File() { ex_close(id_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  ExodusMesh mesh() {
    ex_init_params sizes{};
    require(ex_get_init_ext(id_, &sizes), "its header");
    if (sizes.num_dim != 2 && sizes.num_dim != 3)
      fail("it has " + std::to_string(sizes.num_dim) + " dimensions instead of 2 or 3");
    const auto bytes = static_cast<std::int64_t>(std::filesystem::file_size(path_));
    for (std::int64_t count :
         {sizes.num_nodes, sizes.num_elem, sizes.num_elem_blk, sizes.num_side_sets, sizes.num_node_sets})
      if (count < 0 || count > bytes) // the numbers of nodes and elements alone take more
        fail("its header is damaged");
    mesh_.dimension = static_cast<int>(sizes.num_dim);
    nodes_ = sizes.num_nodes;
    readPoints();
    readBlocks(sizes.num_elem_blk);
    readSets(sizes.num_side_sets, sizes.num_node_sets);
    readFields();
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError("\"" + path_ + "\" cannot be read: " + what);
  }
  void require(int status, const std::string& what) const {
    if (status < 0)
      fail(what + " cannot be read; the file is damaged");
  }

  std::vector<std::int64_t> ids(ex_entity_type type, std::int64_t count, const char* what) const {
    std::vector<std::int64_t> result(at(count));
    if (count > 0)
      require(ex_get_ids(id_, type, result.data()), std::string("the numbers of its ") + what);
    return result;
  }

  std::string nameOf(ex_entity_type type, std::int64_t id, const char* kind) const {
    std::vector<char> name(at(ex_inquire_int(id_, EX_INQ_MAX_READ_NAME_LENGTH)) + 1, '\0');
    const bool hasName = ex_get_name(id_, type, id, name.data()) >= 0 && name[0] != '\0';
    return hasName ? std::string(name.data()) : kind + ("_" + std::to_string(id));
  }

  void readPoints() {
    // Exodus 6.02 leaves alone what is the first variable of a file, and says that all is well.
    std::vector<double> x(at(nodes_), std::numeric_limits<double>::quiet_NaN()), y = x, z = x;
    if (mesh_.dimension == 2)
      std::fill(z.begin(), z.end(), 0.0);
    require(ex_get_coord(id_, x.data(), y.data(), mesh_.dimension == 3 ? z.data() : nullptr), "its nodes");
    mesh_.points.reserve(3 * x.size());
    for (std::size_t k = 0; k < x.size(); ++k) {
      if (!std::isfinite(x[k]) || !std::isfinite(y[k]) || !std::isfinite(z[k]))
        fail("node " + std::to_string(k + 1) + " has no coordinates or infinite ones; write the file again");
      mesh_.points.insert(mesh_.points.end(), {x[k], y[k], z[k]});
    }
  }

  CellType typeOf(const ex_block& block, const std::string& name) const {
    std::string text;
    for (const char* c = block.topology; *c != '\0'; ++c)
      text += static_cast<char>(std::toupper(static_cast<unsigned char>(*c)));
    for (const Topology& known : topologies())
      for (CellType type : known.types)
        if (text.rfind(known.head, 0) == 0 && shapeOf(type).nodes == block.num_nodes_per_entry &&
            shapeOf(type).dimension == mesh_.dimension)
          return type;
    fail("its block \"" + name + "\" has elements of the type \"" + block.topology + "\" with " +
         std::to_string(block.num_nodes_per_entry) +
         " nodes, which is not supported; remove the block, or use triangles, quadrilaterals, tetrahedra, "
         "wedges or hexahedra of first or second order");
  }

  void readBlocks(std::int64_t count) {
    for (std::int64_t id : ids(EX_ELEM_BLOCK, count, "blocks")) {
      ex_block block{};
      block.id = id;
      block.type = EX_ELEM_BLOCK;
      const std::string name = nameOf(EX_ELEM_BLOCK, id, "block");
      require(ex_get_block_param(id_, &block), "the block \"" + name + "\"");
      if (block.num_entry == 0)
        continue;
      const CellType type = typeOf(block, name);
      std::vector<std::int64_t> nodes(at(block.num_entry * block.num_nodes_per_entry));
      require(ex_get_conn(id_, EX_ELEM_BLOCK, id, nodes.data(), nullptr, nullptr),
              "the block \"" + name + "\"");
      requireWithin(nodes, nodes_, "the block \"" + name + "\" has elements with node ");
      mesh_.blocks.push_back({name, type, {nodes.begin(), nodes.end()}});
      elements_ += block.num_entry;
    }
    if (mesh_.blocks.empty())
      fail("it has no elements");
  }

  void requireWithin(const std::vector<std::int64_t>& numbers, std::int64_t most,
                     const std::string& what) const {
    for (std::int64_t number : numbers)
      if (number < 1 || number > most)
        fail(what + std::to_string(number) + ", which does not exist; the file is damaged");
  }

  std::int64_t sizeOf(ex_entity_type type, std::int64_t id, const std::string& what) const {
    std::int64_t entries = 0, factors = 0;
    require(ex_get_set_param(id_, type, id, &entries, &factors), what);
    const std::int64_t most = type == EX_NODE_SET ? nodes_ : 8 * elements_;
    if (entries < 0 || entries > most)
      fail(what + " has " + std::to_string(entries) + " entries; the file is damaged");
    return entries;
  }

  void readSets(std::int64_t sideSets, std::int64_t nodeSets) {
    for (std::int64_t id : ids(EX_SIDE_SET, sideSets, "side sets")) {
      const std::string name = nameOf(EX_SIDE_SET, id, "sideset"), what = "the side set \"" + name + "\"";
      std::vector<std::int64_t> elements(at(sizeOf(EX_SIDE_SET, id, what))), sides(elements.size());
      if (elements.empty())
        continue;
      require(ex_get_set(id_, EX_SIDE_SET, id, elements.data(), sides.data()), what);
      requireWithin(elements, elements_, what + " has the element ");
      mesh_.sideSets.push_back({name, {elements.begin(), elements.end()}, {sides.begin(), sides.end()}});
    }
    for (std::int64_t id : ids(EX_NODE_SET, nodeSets, "node sets")) {
      const std::string name = nameOf(EX_NODE_SET, id, "nodeset"), what = "the node set \"" + name + "\"";
      std::vector<std::int64_t> nodes(at(sizeOf(EX_NODE_SET, id, what)));
      if (nodes.empty())
        continue;
      require(ex_get_set(id_, EX_NODE_SET, id, nodes.data(), nullptr), what);
      requireWithin(nodes, nodes_, what + " has the node ");
      mesh_.nodeSets.push_back({name, {nodes.begin(), nodes.end()}});
    }
  }

  void readFields() {
    int count = 0;
    const auto times = static_cast<int>(ex_inquire_int(id_, EX_INQ_TIME));
    if (times < 1 || ex_get_variable_param(id_, EX_NODAL, &count) < 0)
      return;
    for (int k = 1; k <= count; ++k) {
      std::vector<char> name(at(ex_inquire_int(id_, EX_INQ_MAX_READ_NAME_LENGTH)) + 1, '\0');
      std::vector<double> values(at(nodes_));
      if (ex_get_variable_name(id_, EX_NODAL, k, name.data()) >= 0)
        require(ex_get_var(id_, times, EX_NODAL, k, 1, nodes_, values.data()),
                std::string("the variable \"") + name.data() + "\"");
      mesh_.fields[name.data()] = std::move(values);
    }
  }

  std::string path_;
  int id_ = -1;
  std::int64_t nodes_ = 0, elements_ = 0;
  ExodusMesh mesh_;
};

} // namespace

ExodusMesh readExodus(const std::string& path) {
  return File(path).mesh();
}

} // namespace Harmos::fem

#else

namespace Harmos::fem {

ExodusMesh readExodus(const std::string& path) {
  throw InputError("\"" + path +
                   "\" cannot be read: Harmos was built without Exodus. Install libexodusii-dev and "
                   "configure with -DHARMOS_ENABLE_EXODUS=ON");
}

} // namespace Harmos::fem

#endif

namespace Harmos::fem {

bool isExodus(const std::string& path) {
  std::string end = std::filesystem::path(path).extension().string();
  std::transform(end.begin(), end.end(), end.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const std::array<const char*, 5> ends = {".exo", ".e", ".ex2", ".exii", ".g"};
  return std::find(ends.begin(), ends.end(), end) != ends.end();
}

} // namespace Harmos::fem
