// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_GmshLibrary.hpp"

#include "Harmos_Errors.hpp"

#include <array>
#include <dlfcn.h>
#include <gmshc.h>
#include <type_traits>

namespace Harmos::fem::Details::gmsh {
namespace {

#define HARMOS_GMSH_TEXT_OF(x) #x
#define HARMOS_GMSH_TEXT(x) HARMOS_GMSH_TEXT_OF(x)

// First by the name that the loader knows it by, then where it was built with.
void* load() {
  constexpr std::array<const char*, 2> names = {
      "libgmsh.so." HARMOS_GMSH_TEXT(GMSH_API_VERSION_MAJOR) "." HARMOS_GMSH_TEXT(GMSH_API_VERSION_MINOR),
      HARMOS_GMSH_LIBRARY};
  std::string reasons;
  for (const char* name : names) {
    if (void* library = dlopen(name, RTLD_LAZY | RTLD_LOCAL))
      return library;
    reasons += std::string(reasons.empty() ? "" : "; ") + dlerror();
  }
  throw InputError("cannot load Gmsh, which reads this file: " + reasons + ". Install " + names[0] +
                   " (Debian: the package libgmsh of that release)");
}

void* symbol(const char* name) {
  static void* const library = load(); // tried again after a failure
  if (void* found = dlsym(library, name))
    return found;
  throw InputError(std::string("the Gmsh that was loaded lacks ") + name + "; install release " +
                   GMSH_API_VERSION);
}

// The function of this name, with its type; the library is not linked.
#define HARMOS_GMSH(name) (reinterpret_cast<decltype(&::name)>(symbol(#name)))

void release(void* memory) {
  if (memory != nullptr)
    HARMOS_GMSH(gmshFree)(memory);
}

// An array or a text that a call returns.
template<class T>
struct Array {
  T* data = nullptr;
  std::size_t size = 0;

  Array() = default;
  Array(const Array&) = delete;
  Array& operator=(const Array&) = delete;
  ~Array() { release(data); }
  std::vector<T> values() const { return std::vector<T>(data, data + size); }
};

// Several of them.
template<class T>
struct Arrays {
  T** data = nullptr;
  std::size_t* sizes = nullptr;
  std::size_t size = 0;

  Arrays() = default;
  Arrays(const Arrays&) = delete;
  Arrays& operator=(const Arrays&) = delete;
  ~Arrays() {
    for (std::size_t k = 0; k < size; ++k)
      release(data[k]);
    release(data);
    release(sizes);
  }
  std::vector<std::vector<T>> values() const {
    std::vector<std::vector<T>> result;
    for (std::size_t k = 0; k < size; ++k)
      result.emplace_back(data[k], data[k] + sizes[k]);
    return result;
  }
};

std::string textOf(const Array<char>& text) {
  return text.data == nullptr ? "" : text.data;
}

void require(int error) {
  if (error == 0)
    return;
  Array<char> reason;
  int failure = 0;
  HARMOS_GMSH(gmshLoggerGetLastError)(&reason.data, &failure);
  throw GmshFailure(failure == 0 ? textOf(reason) : "");
}

// The last argument of each function is its error.
template<class Function, class... Arguments>
auto call(Function* function, Arguments... arguments) {
  int error = 0;
  if constexpr (std::is_void_v<decltype(function(arguments..., &error))>) {
    function(arguments..., &error);
    require(error);
  } else {
    const auto result = function(arguments..., &error);
    require(error);
    return result;
  }
}

Pairs pairsOf(const Array<int>& numbers) {
  Pairs result;
  for (std::size_t k = 0; k + 1 < numbers.size; k += 2)
    result.emplace_back(numbers.data[k], numbers.data[k + 1]);
  return result;
}

using Size = std::function<double(double, double, double)>;

// Newer releases add the size that Gmsh would take by itself.
struct SizeCallback {
  static double at(int, int, double x, double y, double z, void* size) {
    return (*static_cast<Size*>(size))(x, y, z);
  }
  static double at(int, int, double x, double y, double z, double, void* size) {
    return (*static_cast<Size*>(size))(x, y, z);
  }
};

// Gmsh keeps a pointer to it until the session ends.
Size sizes;

} // namespace

void initialize() {
  call(HARMOS_GMSH(gmshInitialize), 0, nullptr, 0);
}

void finalize() noexcept {
  int ignored = 0; // nothing is left to be done about it
  HARMOS_GMSH(gmshFinalize)(&ignored);
  sizes = nullptr;
}

void open(const std::string& path) {
  call(HARMOS_GMSH(gmshOpen), path.c_str());
}

void setNumber(const std::string& option, double value) {
  call(HARMOS_GMSH(gmshOptionSetNumber), option.c_str(), value);
}

std::string getString(const std::string& option) {
  Array<char> text;
  call(HARMOS_GMSH(gmshOptionGetString), option.c_str(), &text.data);
  return textOf(text);
}

namespace model {

void add(const std::string& name) {
  call(HARMOS_GMSH(gmshModelAdd), name.c_str());
}

Pairs getEntities(int dimension) {
  Array<int> entities;
  call(HARMOS_GMSH(gmshModelGetEntities), &entities.data, &entities.size, dimension);
  return pairsOf(entities);
}

int addDiscreteEntity(int dimension, int tag) {
  return call(HARMOS_GMSH(gmshModelAddDiscreteEntity), dimension, tag, nullptr, std::size_t{0});
}

Pairs getPhysicalGroups() {
  Array<int> groups;
  call(HARMOS_GMSH(gmshModelGetPhysicalGroups), &groups.data, &groups.size, -1);
  return pairsOf(groups);
}

std::vector<int> getEntitiesForPhysicalGroup(int dimension, int tag) {
  Array<int> entities;
  call(HARMOS_GMSH(gmshModelGetEntitiesForPhysicalGroup), dimension, tag, &entities.data, &entities.size);
  return entities.values();
}

std::string getPhysicalName(int dimension, int tag) {
  Array<char> name;
  call(HARMOS_GMSH(gmshModelGetPhysicalName), dimension, tag, &name.data);
  return textOf(name);
}

void addPhysicalGroup(int dimension, std::vector<int> entities, const std::string& name) {
  const int tag =
      call(HARMOS_GMSH(gmshModelAddPhysicalGroup), dimension, entities.data(), entities.size(), -1);
  call(HARMOS_GMSH(gmshModelSetPhysicalName), dimension, tag, name.c_str());
}

void removePhysicalGroups() {
  call(HARMOS_GMSH(gmshModelRemovePhysicalGroups), nullptr, std::size_t{0});
}

} // namespace model

namespace mesh {

void generate(int dimension) {
  call(HARMOS_GMSH(gmshModelMeshGenerate), dimension);
}

void setSizeCallback(std::function<double(double, double, double)> size) {
  sizes = std::move(size);
  int error = 0;
  HARMOS_GMSH(gmshModelMeshSetSizeCallback)(SizeCallback::at, &sizes, &error);
  require(error);
}

Nodes getNodes() {
  Array<std::size_t> tags;
  Array<double> coordinates, parameters;
  call(HARMOS_GMSH(gmshModelMeshGetNodes), &tags.data, &tags.size, &coordinates.data, &coordinates.size,
       &parameters.data, &parameters.size, -1, -1, 0, 0);
  return {tags.values(), coordinates.values()};
}

void addNodes(int dimension, int entity, Tags tags, std::vector<double> coordinates) {
  call(HARMOS_GMSH(gmshModelMeshAddNodes), dimension, entity, tags.data(), tags.size(), coordinates.data(),
       coordinates.size(), nullptr, std::size_t{0});
}

std::vector<int> getElementTypes(int dimension) {
  Array<int> types;
  call(HARMOS_GMSH(gmshModelMeshGetElementTypes), &types.data, &types.size, dimension, -1);
  return types.values();
}

ElementProperties getElementProperties(int type) {
  ElementProperties result;
  Array<char> name;
  Array<double> coordinates;
  call(HARMOS_GMSH(gmshModelMeshGetElementProperties), type, &name.data, &result.dimension, &result.order,
       &result.nodes, &coordinates.data, &coordinates.size, &result.corners);
  result.name = textOf(name);
  result.coordinates = coordinates.values();
  return result;
}

Elements getElements(int dimension, int entity) {
  Array<int> types;
  Arrays<std::size_t> tags, nodes;
  call(HARMOS_GMSH(gmshModelMeshGetElements), &types.data, &types.size, &tags.data, &tags.sizes, &tags.size,
       &nodes.data, &nodes.sizes, &nodes.size, dimension, entity);
  return {types.values(), tags.values(), nodes.values()};
}

void addElementsByType(int entity, int type, Tags nodes) {
  call(HARMOS_GMSH(gmshModelMeshAddElementsByType), entity, type, nullptr, std::size_t{0}, nodes.data(),
       nodes.size());
}

} // namespace mesh

namespace view {

std::vector<int> getTags() {
  Array<int> views;
  call(HARMOS_GMSH(gmshViewGetTags), &views.data, &views.size);
  return views.values();
}

std::string getName(int view) {
  const int index = call(HARMOS_GMSH(gmshViewGetIndex), view);
  return getString("View[" + std::to_string(index) + "].Name");
}

ModelData getModelData(int view) {
  ModelData result;
  Array<char> kind;
  Array<std::size_t> tags;
  Arrays<double> rows;
  double time = 0.0;
  call(HARMOS_GMSH(gmshViewGetModelData), view, 0, &kind.data, &tags.data, &tags.size, &rows.data,
       &rows.sizes, &rows.size, &time, &result.components);
  result.kind = textOf(kind);
  result.tags = tags.values();
  result.rows = rows.values();
  return result;
}

void addNodeData(const std::string& name, const std::string& model, Tags nodes,
                 const std::vector<std::vector<double>>& rows) {
  const int view = call(HARMOS_GMSH(gmshViewAdd), name.c_str(), -1);
  std::vector<const double*> data;
  std::vector<std::size_t> sizes;
  for (const std::vector<double>& row : rows) {
    data.push_back(row.data());
    sizes.push_back(row.size());
  }
  call(HARMOS_GMSH(gmshViewAddModelData), view, 0, model.c_str(), "NodeData", nodes.data(), nodes.size(),
       data.data(), sizes.data(), data.size(), 0.0, -1, 0);
}

} // namespace view
} // namespace Harmos::fem::Details::gmsh
