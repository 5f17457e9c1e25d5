// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CutMeshFile.hpp"
#include "Harmos_Partition.hpp"
#include "Harmos_TestBodies.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TornBody.hpp"

#include <Teuchos_DefaultMpiComm.hpp>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace test_cut_mesh_file {

using namespace Harmos;
using fem::CellType;
using fem::CutBody;
using fem::CutMeshFile;
using fem::PlacedMesh;

namespace {

// Every rank writes files of its own, which do not outlive the tests.
class Files {
 public:
  Files() : directory_("/tmp/harmos_test_cut_" + std::to_string(getpid())) {
    std::filesystem::create_directory(directory_);
  }
  ~Files() {
    std::error_code ignored;
    std::filesystem::remove_all(directory_, ignored);
  }
  Files(const Files&) = delete;
  Files& operator=(const Files&) = delete;
  const std::string& directory() const { return directory_; }

 private:
  std::string directory_;
};

std::string path(const std::string& name) {
  static const Files files;
  return files.directory() + "/" + name;
}

CutBody cutBody(const std::string& name, CellType type, int cells, int parts) {
  const fem::BodyMesh whole = testBody(type, cells);
  const fem::Partition partition = partitionCells(whole, parts);
  CutBody body;
  body.name = name;
  body.cellType = type;
  body.nodes = whole.mesh.numberOfNodes();
  body.regions = whole.regions;
  body.subdomains = tear(whole, partition.part, partition.parts, 0);
  return body;
}

std::vector<CutBody> twoBodies() {
  return {cutBody("ring", CellType::Tetrahedron10, 4, 5),
          cutBody("pad of rubber", CellType::Quadrilateral9, 8, 7)};
}

std::string written(const std::string& name) {
  writeCutMesh(Teuchos::MpiComm<int>(MPI_COMM_SELF), path(name), twoBodies());
  return path(name);
}

} // namespace

TEST(CutMeshFile, every_subdomain_comes_back_by_itself) {
  const std::vector<CutBody> bodies = twoBodies();
  const CutMeshFile file(written("whole.h5"));
  ASSERT_EQ(file.bodies().size(), bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    EXPECT_EQ(file.bodies()[b].name, bodies[b].name);
    EXPECT_EQ(file.bodies()[b].cellType, bodies[b].cellType);
    EXPECT_EQ(file.bodies()[b].nodes, bodies[b].nodes);
    EXPECT_EQ(file.bodies()[b].regions, bodies[b].regions);
    ASSERT_EQ(file.bodies()[b].subdomains, static_cast<int>(bodies[b].subdomains.size()));
    for (int s = file.bodies()[b].subdomains; s-- > 0;) {
      PlacedMesh expected = bodies[b].subdomains[static_cast<std::size_t>(s)];
      expectSame(file.subdomain(b, s, 0), expected);
      for (long long& number : expected.boundaryNumbers)
        number += 1000;
      expectSame(file.subdomain(b, s, 1000), expected);
    }
  }
}

// A byte that differs anywhere in the meshes is seen, in whatever it lies; a file that is cut off ends at
// once.
TEST(CutMeshFile, damage_is_told) {
  const std::string name = written("damaged.h5");
  std::vector<char> bytes;
  {
    std::ifstream in(name, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
  }
  const auto readAll = [&](const std::vector<char>& content) {
    std::ofstream(name, std::ios::binary).write(content.data(), static_cast<std::streamsize>(content.size()));
    const CutMeshFile file(name);
    for (std::size_t b = 0; b < file.bodies().size(); ++b)
      for (int s = 0; s < file.bodies()[b].subdomains; ++s)
        file.subdomain(b, s, 0);
  };
  readAll(bytes);
  for (std::size_t share = 0; share < 16; ++share) {
    const std::vector<char> front(bytes.begin(),
                                  bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() * share / 16));
    EXPECT_TRUE(contains(inputErrorOf([&] { readAll(front); }), "the mesh file \"" + name + "\"")) << share;
  }
  // The first coordinate that is not 0 of the first body: as bytes it stands in the file but once or in
  // copies.
  const double x = twoBodies()[0].subdomains[0].mesh->coordinates[3];
  const char* begin = reinterpret_cast<const char*>(&x);
  std::vector<char> changed = bytes;
  const auto place = std::search(changed.begin(), changed.end(), begin, begin + sizeof(x));
  ASSERT_NE(place, changed.end());
  *(place + 3) ^= 1;
  std::ofstream(name, std::ios::binary).write(changed.data(), static_cast<std::streamsize>(changed.size()));
  // Who does not own that subdomain does not read it.
  const CutMeshFile file(name);
  const std::vector<CutBody> bodies = twoBodies();
  int damaged = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (int s = 0; s < file.bodies()[b].subdomains; ++s)
      if (inputErrorOf([&] { file.subdomain(b, s, 0); }).empty())
        expectSame(file.subdomain(b, s, 0), bodies[b].subdomains[static_cast<std::size_t>(s)]);
      else
        ++damaged;
  EXPECT_EQ(damaged, 1);
  EXPECT_TRUE(contains(inputErrorOf([&] { readAll(changed); }),
                       "has a wrong checksum; write it again with harmos-mesh"));
}

TEST(CutMeshFile, what_is_no_such_file_is_refused) {
  EXPECT_TRUE(
      contains(inputErrorOf([] { CutMeshFile("nowhere.h5"); }), "mesh file not found: \"nowhere.h5\""));
  std::ofstream(path("text.h5")) << "not HDF5\n";
  EXPECT_TRUE(contains(inputErrorOf([] { CutMeshFile(path("text.h5")); }), "cannot be read"));
  EXPECT_TRUE(CutMeshFile::isOne("a/b.h5"));
  EXPECT_FALSE(CutMeshFile::isOne("a/b.msh"));
}

} // namespace test_cut_mesh_file
