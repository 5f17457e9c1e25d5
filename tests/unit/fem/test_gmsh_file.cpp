// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BodyBlocks.hpp"
#include "Harmos_CellGraph.hpp"
#include "Harmos_CellIntegrator.hpp"
#include "Harmos_GmshFile.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <unistd.h>

namespace test_gmsh_file {

using namespace Harmos;
using fem::BodyMesh;
using fem::CellType;
using fem::Point;
using fem::readGmsh;

namespace {

/// A directory of its own for the files of a test.
class GmshFile : public testing::Test {
 protected:
  void SetUp() override {
    if (!fem::canReadGmsh())
      GTEST_SKIP() << "this build has no Gmsh (HARMOS_ENABLE_GMSH)";
    directory_ = std::filesystem::temp_directory_path() / ("harmos_gmsh_" + std::to_string(::getpid()));
    std::filesystem::create_directories(directory_);
  }
  void TearDown() override {
    std::error_code failure;
    std::filesystem::remove_all(directory_, failure);
  }
  std::string path(const std::string& name) const { return (directory_ / name).string(); }
  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(path(name)) << text;
    return path(name);
  }

 private:
  std::filesystem::path directory_;
};

/// A square of side 2 with a disc of radius 1/2, whose surface is oriented clockwise.
std::string discInSquare(bool quadrilaterals, int order, double z = 0.0) {
  const std::string height = ", " + std::to_string(z) + ", 0.3};\n";
  return "Point(1) = {0, 0" + height + "Point(2) = {2, 0" + height + "Point(3) = {2, 2" + height +
         "Point(4) = {0, 2" + height + "Point(5) = {1, 1" + height + "Point(6) = {1.5, 1" + height +
         "Point(7) = {1, 1.5" + height + "Point(8) = {0.5, 1" + height + "Point(9) = {1, 0.5" + height +
         R"(
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Circle(5) = {6, 5, 7}; Circle(6) = {7, 5, 8}; Circle(7) = {8, 5, 9}; Circle(8) = {9, 5, 6};
Curve Loop(1) = {1, 2, 3, 4}; Curve Loop(2) = {5, 6, 7, 8}; Curve Loop(3) = {-8, -7, -6, -5};
Plane Surface(1) = {1, 2}; Plane Surface(2) = {3};
Physical Surface("matrix") = {1}; Physical Surface("inclusion") = {2};
Physical Curve("bottom") = {1}; Physical Curve("outside") = {1, 2, 3, 4}; Physical Curve("circle") = {5, 6, 7, 8};
Physical Point("corner") = {1};
)" + (quadrilaterals ? "Recombine Surface{:}; Mesh.SubdivisionAlgorithm = 1;\n" : "") +
         "Mesh.ElementOrder = " + std::to_string(order) + ";\n";
}

/// Two unit cubes, one on the other; the second is extruded downwards if wanted.
std::string incomplete(bool isSerendipity) {
  return std::string("Mesh.SecondOrderIncomplete = ") + (isSerendipity ? "1;\n" : "0;\n");
}

std::string twoCubes(bool hexahedra, int order, bool isDownwards = false, bool wedges = false) {
  const std::string layers = hexahedra || wedges ? " Layers{2}; Recombine;" : "";
  const std::string height = isDownwards ? "-1" : "1";
  return R"(
Point(1) = {0, 0, 0, 0.5}; Point(2) = {1, 0, 0, 0.5}; Point(3) = {1, 1, 0, 0.5}; Point(4) = {0, 1, 0, 0.5};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
)" +
         std::string(hexahedra ? "Transfinite Curve{:} = 4; Transfinite Surface{1}; Recombine Surface{1};\n"
                               : "") +
         "a[] = Extrude {0, 0, " + height + "} { Surface{1};" + layers + " };\n" + "b[] = Extrude {0, 0, " +
         height + "} { Surface{a[0]};" + layers + " };\n" + R"(
Physical Volume("lower") = {a[1]}; Physical Volume("upper") = {b[1]};
Physical Surface("bottom") = {1}; Physical Surface("middle") = {a[0]}; Physical Surface("top") = {b[0]};
Physical Curve("edge") = {1}; Physical Point("corner") = {1};
Mesh.ElementOrder = )" +
         std::to_string(order) + ";\n";
}

/// Area or volume; throws for cells with a Jacobian that is not positive.
double sizeOf(const BodyMesh& body) {
  constexpr int degree = 4;
  const fem::ReferenceElement element(body.mesh.cellType, degree);
  fem::CellIntegrator integrator(body.mesh, element);
  double sum = 0.0;
  for (int c = 0; c < body.mesh.numberOfCells(); ++c) {
    integrator.turnTo(c);
    sum += integrator.size();
  }
  return sum;
}

double distanceOf(const Point& a, const Point& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

double triangle(const Point& a, const Point& b, const Point& c) {
  const double x = distanceOf(a, b), y = distanceOf(b, c), z = distanceOf(c, a), s = 0.5 * (x + y + z);
  return std::sqrt(s * (s - x) * (s - y) * (s - z));
}

/// Length or area of a boundary part, its sides taken as straight.
double sizeOfPart(const BodyMesh& body, const std::string& name) {
  double sum = 0.0;
  for (const fem::Side& side : body.sides.at(name)) {
    const std::vector<int> nodes = body.mesh.nodesOf(side);
    const auto x = [&](std::size_t k) { return body.mesh.local(nodes[k]); };
    const int corners = fem::shapeOf(body.mesh.typeOf(side)).corners;
    if (corners == 2)
      sum += distanceOf(x(0), x(1));
    else
      sum += triangle(x(0), x(1), x(2)) + (corners == 4 ? triangle(x(0), x(2), x(3)) : 0.0);
  }
  return sum;
}

std::string refusalOf(const std::string& path, const std::vector<fem::GmshBody>& bodies, int dimension = 2) {
  return inputErrorOf([&] { readGmsh(path, bodies, dimension); });
}

} // namespace

TEST(GmshFileWithoutGmsh, says_how_to_get_it) {
  if (fem::canReadGmsh())
    GTEST_SKIP() << "this build has Gmsh";
  const std::string text = refusalOf("scene.msh", {});
  EXPECT_TRUE(contains(text, "\"scene.msh\" cannot be read")) << text;
  EXPECT_TRUE(contains(text, "-DHARMOS_ENABLE_GMSH=ON")) << text;
}

// Cells of large bodies come along a curve: neighbours in memory are neighbours in space; regions, parts and
// points go with them.
TEST_F(GmshFile, large_bodies_come_along_a_curve) {
  const std::string geo = R"(
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {3, 0, 0};
Point(4) = {0, 1, 0}; Point(5) = {1, 1, 0}; Point(6) = {3, 1, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {4, 5}; Line(4) = {5, 6};
Line(5) = {1, 4}; Line(6) = {2, 5}; Line(7) = {3, 6};
Curve Loop(1) = {1, 6, -3, -5}; Curve Loop(2) = {2, 7, -4, -6};
Plane Surface(1) = {1}; Plane Surface(2) = {2};
Transfinite Curve{1 : 7} = 91; Transfinite Surface{1, 2};
Physical Surface("left") = {1}; Physical Surface("right") = {2};
Physical Curve("end") = {7}; Physical Point("corner") = {6};
Mesh.ElementOrder = )";
  for (const int order : {1, 2}) {
    const BodyMesh body =
        readGmsh(file("large.geo", geo + std::to_string(order) + ";\n"), {{"both", {"left", "right"}}}, 2)[0];
    const fem::Mesh& mesh = body.mesh;
    ASSERT_GE(mesh.numberOfCells(), 30000);
    EXPECT_TRUE(body.isAlongCurve);
    EXPECT_EQ(mesh.numberOfNodes(), order == 1 ? 181 * 91 : 361 * 181);
    EXPECT_NEAR(sizeOf(body), 3.0, 1e-10);
    EXPECT_NEAR(sizeOfPart(body, "end"), 1.0, 1e-12);
    ASSERT_EQ(body.nodes.at("corner").size(), 1u);
    EXPECT_EQ(mesh.local(body.nodes.at("corner")[0]), (Point{3.0, 1.0, 0.0}));
    EXPECT_EQ(mesh.boundary, nodesOf(mesh, boundarySides(mesh)));
    const fem::CellGraph graph = fem::graphOf(mesh);
    ASSERT_EQ(mesh.regions.size(), graph.centres.size());
    double apart = 0.0;
    for (std::size_t c = 0; c < graph.centres.size(); ++c) {
      EXPECT_EQ(mesh.regions[c], graph.centres[c][0] < 1.0 ? 0 : 1);
      if (c > 0)
        apart += std::hypot(graph.centres[c][0] - graph.centres[c - 1][0],
                            graph.centres[c][1] - graph.centres[c - 1][1]);
    }
    // Cells are 1/90 high and up to 2/90 wide; curves make a few large steps.
    EXPECT_LT(apart / static_cast<double>(graph.centres.size()), 3.0 / 90.0);
  }
}

TEST_F(GmshFile, plane_bodies_of_all_types) {
  for (const CellType type : {CellType::Triangle3, CellType::Triangle6, CellType::Quadrilateral4,
                              CellType::Quadrilateral9, CellType::Quadrilateral8}) {
    const fem::CellShape& shape = shapeOf(type);
    SCOPED_TRACE(shape.name);
    const std::string geo =
        file("disc.geo", discInSquare(!shape.isSimplex, shape.order) + incomplete(shape.isSerendipity));
    const std::vector<BodyMesh> bodies = readGmsh(geo, {{"outer", {"matrix"}}, {"inner", {"inclusion"}}}, 2);
    ASSERT_EQ(bodies.size(), 2u);
    const BodyMesh &outer = bodies[0], &inner = bodies[1];
    EXPECT_EQ(outer.name, "outer");
    EXPECT_EQ(inner.regions, std::vector<std::string>{"inclusion"});
    for (const BodyMesh& body : bodies) {
      EXPECT_EQ(body.mesh.cellType, type);
      EXPECT_GT(body.mesh.numberOfCells(), 8);
      EXPECT_EQ(body.mesh.boundary, nodesOf(body.mesh, boundarySides(body.mesh)));
    }
    // The disc's boundary is the same in both, so that their sum is exact.
    EXPECT_NEAR(sizeOf(outer) + sizeOf(inner), 4.0, 1e-12);
    EXPECT_NEAR(sizeOf(inner), M_PI / 4, shape.order == 1 ? 0.05 : 5e-4);
    EXPECT_NEAR(sizeOfPart(outer, "bottom"), 2.0, 1e-12);
    EXPECT_NEAR(sizeOfPart(outer, "outside"), 8.0, 1e-12);
    EXPECT_NEAR(sizeOfPart(outer, "circle"), M_PI, 0.05);
    EXPECT_NEAR(sizeOfPart(outer, "circle"), sizeOfPart(inner, "circle"), 1e-12);
    EXPECT_EQ(inner.sides.count("bottom"), 0u);
    ASSERT_EQ(outer.nodes.at("corner").size(), 1u);
    EXPECT_LT(distanceOf(outer.mesh.local(outer.nodes.at("corner").front()), {0, 0, 0}), 1e-14);
    EXPECT_EQ(inner.nodes.count("corner"), 0u);
    // All nodes of the circle, those on the edges as well.
    for (const BodyMesh& body : bodies)
      for (int node : nodesOf(body.mesh, body.sides.at("circle")))
        EXPECT_NEAR(distanceOf(body.mesh.local(node), {1, 1, 0}), 0.5, 1e-6);
  }
}

TEST_F(GmshFile, solid_bodies_of_all_types) {
  for (const CellType type :
       {CellType::Tetrahedron4, CellType::Tetrahedron10, CellType::Hexahedron8, CellType::Hexahedron27,
        CellType::Hexahedron20, CellType::Wedge6, CellType::Wedge15, CellType::Wedge18})
    for (const bool isDownwards : {false, true}) {
      const fem::CellShape& shape = shapeOf(type);
      SCOPED_TRACE(shape.name + (isDownwards ? ", downwards" : ""));
      const std::string geo = file(
          "cubes.geo", twoCubes(!shape.isSimplex && !shape.isWedge, shape.order, isDownwards, shape.isWedge) +
                           incomplete(shape.isSerendipity));
      const std::vector<BodyMesh> bodies = readGmsh(geo, {{"a", {"lower"}}, {"b", {"upper"}}}, 3);
      for (const BodyMesh& body : bodies) {
        EXPECT_EQ(body.mesh.cellType, type);
        EXPECT_NEAR(sizeOf(body), 1.0, 1e-12);
        EXPECT_NEAR(sizeOfPart(body, "middle"), 1.0, 1e-12);
      }
      EXPECT_NEAR(sizeOfPart(bodies[0], "bottom"), 1.0, 1e-12);
      EXPECT_NEAR(sizeOfPart(bodies[1], "top"), 1.0, 1e-12);
      EXPECT_EQ(bodies[0].sides.count("top"), 0u);
      EXPECT_EQ(bodies[0].nodes.at("corner").size(), 1u);
      EXPECT_GE(bodies[0].nodes.at("edge").size(), 3u);
      for (int node : bodies[0].nodes.at("edge")) {
        EXPECT_NEAR(bodies[0].mesh.local(node)[1], 0.0, 1e-14);
        EXPECT_NEAR(bodies[0].mesh.local(node)[2], 0.0, 1e-14);
      }
      if (!shape.isSimplex && !shape.isWedge)
        EXPECT_EQ(bodies[0].mesh.numberOfCells(), 18);
      if (shape.isWedge)
        EXPECT_EQ(bodies[0].sides.at("bottom").size(), bodies[0].sides.at("middle").size());
    }
}

TEST_F(GmshFile, regions_of_a_body_share_nodes_and_bodies_do_not) {
  const std::string geo = file("cubes.geo", twoCubes(true, 1));
  const std::vector<BodyMesh> apart = readGmsh(geo, {{"a", {"lower"}}, {"b", {"upper"}}}, 3);
  const std::vector<BodyMesh> one = readGmsh(geo, {{"both", {"lower", "upper"}}}, 3);
  EXPECT_EQ(apart[0].mesh.numberOfNodes(), 48);
  EXPECT_EQ(apart[1].mesh.numberOfNodes(), 48);
  ASSERT_EQ(one.size(), 1u);
  EXPECT_EQ(one[0].mesh.numberOfNodes(), 48 + 48 - 16);
  EXPECT_EQ(one[0].regions, (std::vector<std::string>{"lower", "upper"}));
  EXPECT_EQ(std::count(one[0].mesh.regions.begin(), one[0].mesh.regions.end(), 1), 18);
  EXPECT_EQ(one[0].mesh.region(0), 0);
  EXPECT_EQ(one[0].sides.count("middle"), 0u) << "an inner surface is no boundary part";
  EXPECT_NEAR(sizeOf(one[0]), 2.0, 1e-12);
}

TEST_F(GmshFile, a_saved_mesh_is_that_of_its_geometry) {
  const std::string geo =
      file("saving.geo", discInSquare(false, 2) + "Mesh 2;\nSave \"" + path("saved.msh") + "\";\n");
  const std::vector<fem::GmshBody> wanted = {{"all", {"matrix", "inclusion"}}};
  const BodyMesh meshed = readGmsh(geo, wanted, 2).front();
  const BodyMesh saved = readGmsh(path("saved.msh"), wanted, 2).front();
  EXPECT_EQ(meshed.mesh.cells, saved.mesh.cells);
  EXPECT_EQ(meshed.mesh.regions, saved.mesh.regions);
  ASSERT_EQ(meshed.mesh.coordinates.size(), saved.mesh.coordinates.size());
  for (std::size_t k = 0; k < meshed.mesh.coordinates.size(); ++k) // files hold sixteen digits
    EXPECT_NEAR(meshed.mesh.coordinates[k], saved.mesh.coordinates[k], 1e-14);
  EXPECT_EQ(meshed.sides.size(), saved.sides.size());
  EXPECT_NEAR(sizeOf(saved), 4.0, 1e-12);
}

TEST_F(GmshFile, cells_that_a_file_repeats_count_once) {
  const std::string geo = file("repeating.geo", discInSquare(false, 1) + R"(
Physical Surface("everything") = {1, 2}; Physical Curve("left") = {4};
Mesh 2; Mesh.MshFileVersion = 2.2; Save ")" + path("repeated.msh") +
                                                    "\";\n");
  const BodyMesh meshed = readGmsh(geo, {{"all", {"everything"}}}, 2).front();
  const BodyMesh repeated = readGmsh(path("repeated.msh"), {{"all", {"everything"}}}, 2).front();
  EXPECT_EQ(meshed.mesh.cells, repeated.mesh.cells);
  EXPECT_EQ(meshed.mesh.boundary, repeated.mesh.boundary);
  EXPECT_NEAR(sizeOf(repeated), 4.0, 1e-12);
  EXPECT_NEAR(sizeOfPart(repeated, "outside"), 8.0, 1e-12);
  EXPECT_NEAR(sizeOfPart(repeated, "left"), 2.0, 1e-12);
}

TEST_F(GmshFile, a_step_file_has_its_entities_for_groups) {
  const std::string step = path("box.step");
  file("box.geo", "SetFactory(\"OpenCASCADE\"); Box(1) = {0, 0, 0, 1, 2, 3}; Save \"" + step + "\";\n");
  EXPECT_TRUE(contains(refusalOf(path("box.geo"), {{"box", {"no"}}}, 3), "\"volume 1\""));
  ASSERT_TRUE(std::filesystem::exists(step));
  const BodyMesh box = readGmsh(step, {{"box", {"volume 1"}}}, 3).front();
  // Gmsh takes the file's lengths for millimetres, and so do we.
  EXPECT_NEAR(sizeOf(box), 6.0, 1e-9);
  EXPECT_EQ(box.sides.size(), 6u);
  double area = 0.0;
  for (const auto& part : box.sides)
    area += sizeOfPart(box, part.first);
  EXPECT_NEAR(area, 22.0, 1e-9);
}

TEST_F(GmshFile, prints_nothing) {
  testing::internal::CaptureStdout();
  readGmsh(file("disc.geo", discInSquare(false, 1)), {{"all", {"matrix"}}}, 2);
  // OpenCASCADE prints what it dislikes about this one.
  const std::string text = refusalOf(file("rubbish.step", "hello\n"), {{"a", {"volume 1"}}}, 3);
  std::cout << "afterwards";
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "afterwards");
  EXPECT_TRUE(contains(text, "Gmsh cannot read or mesh") && contains(text, "Could not read file")) << text;
}

TEST_F(GmshFile, refuses_files_that_are_none) {
  std::string text = refusalOf(path("absent.msh"), {{"a", {"b"}}});
  EXPECT_TRUE(contains(text, "mesh file not found") && contains(text, "absent.msh")) << text;
  text = refusalOf(path(""), {{"a", {"b"}}});
  EXPECT_TRUE(contains(text, "is not a file")) << text;
  text = refusalOf(file("rubbish.msh", "garbage text here\n"), {{"a", {"b"}}});
  EXPECT_TRUE(contains(text, "rubbish.msh") && contains(text, "syntax error")) << text;
  text = refusalOf(file("cut.msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 2 3"), {{"a", {"b"}}});
  EXPECT_TRUE(contains(text, "Could not read nodes")) << text;
  text = refusalOf(file("empty.geo", "Point(1) = {0, 0, 0};\n"), {{"a", {"b"}}});
  EXPECT_TRUE(contains(text, "holds no cells of dimension 2")) << text;
  text = refusalOf(file("flat.geo", discInSquare(false, 1)), {{"a", {"matrix"}}}, 3);
  EXPECT_TRUE(contains(text, "holds no cells of dimension 3")) << text;
}

TEST_F(GmshFile, refuses_groups_that_are_not_there) {
  const std::string geo = file("disc.geo", discInSquare(false, 1));
  std::string text = refusalOf(geo, {{"inner", {"inclsion"}}});
  EXPECT_TRUE(contains(text, "body \"inner\"") && contains(text, "no physical surface \"inclsion\"")) << text;
  EXPECT_TRUE(contains(text, "did you mean \"inclusion\"?")) << text;
  EXPECT_TRUE(contains(text, "There are: \"inclusion\", \"matrix\"")) << text;
  text = refusalOf(geo, {{"inner", {"circle"}}});
  EXPECT_TRUE(contains(text, "that is a curve there")) << text;
  text = refusalOf(geo, {{"inner", {}}});
  EXPECT_TRUE(contains(text, "has no group")) << text;
  text = refusalOf(geo, {{"a", {"matrix"}}, {"b", {"inclusion", "matrix"}}});
  EXPECT_TRUE(contains(text, "surface 1 belongs to group \"matrix\" of body \"a\" and to group \"matrix\" of "
                             "body \"b\""))
      << text;
}

TEST_F(GmshFile, a_body_of_several_types_has_a_block_of_each) {
  // Quadrilaterals alone within the circle, which is between the types.
  const std::string path =
      file("mixed.geo", discInSquare(false, 2) + "Recombine Surface{2}; Mesh.RecombinationAlgorithm = 3;\n");
  const std::vector<BodyMesh> blocks = readGmsh(path, {{"all", {"matrix", "inclusion"}}}, 2);
  ASSERT_EQ(blocks.size(), 2u);
  double size = 0.0, outside = 0.0;
  std::map<int, Point> places; // by the number in the body
  std::size_t shared = 0;
  for (const BodyMesh& block : blocks) {
    EXPECT_EQ(block.name, "all");
    EXPECT_EQ(block.regions, (std::vector<std::string>{"matrix", "inclusion"}));
    size += sizeOf(block);
    if (block.sides.count("outside") > 0)
      outside += sizeOfPart(block, "outside");
    EXPECT_EQ(block.sides.count("circle"), 0u);
    EXPECT_TRUE(std::is_sorted(block.numbers.begin(), block.numbers.end()));
    ASSERT_EQ(static_cast<int>(block.numbers.size()), block.mesh.numberOfNodes());
    for (int node = 0; node < block.mesh.numberOfNodes(); ++node) {
      const auto [known, isNew] = places.emplace(block.number(node), block.mesh.local(node));
      EXPECT_EQ(known->second, block.mesh.local(node));
      shared += isNew ? 0 : 1;
    }
  }
  EXPECT_NEAR(size, 4.0, 1e-12);
  EXPECT_NEAR(outside, 8.0, 1e-12);
  EXPECT_EQ(blocks[0].nodes.at("circle").size(), shared);
  EXPECT_EQ(blocks[1].nodes.at("circle").size(), shared);
  EXPECT_EQ(static_cast<int>(places.size()), fem::numberOfNodes(blocks));
  EXPECT_EQ(fem::numberOfPieces(blocks), 1);
}

TEST_F(GmshFile, refuses_cells_it_does_not_have) {
  const std::string text = refusalOf(file("cubic.geo", discInSquare(false, 3)), {{"all", {"matrix"}}});
  EXPECT_TRUE(contains(text, "Triangle 10")) << text;
}

TEST_F(GmshFile, refuses_plane_bodies_out_of_the_plane) {
  const std::string lifted = file("lifted.geo", discInSquare(false, 1, 0.5));
  EXPECT_NEAR(sizeOf(readGmsh(lifted, {{"all", {"matrix", "inclusion"}}}, 2).front()), 4.0, 1e-12);
  const std::string text = refusalOf(
      file("tilted.geo", discInSquare(false, 1) + "Rotate{{1, 0, 0}, {0, 0, 0}, 0.1}{Surface{:};}\n"),
      {{"all", {"matrix"}}});
  EXPECT_TRUE(contains(text, "reaches from z = 0 to") && contains(text, "z = constant")) << text;
}

TEST_F(GmshFile, mirrored_solids_are_renumbered) {
  // Corners of a unit cube, which a hexahedron and a tetrahedron number the wrong way round.
  const std::string nodes = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
8
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
5 0 0 1
6 1 0 1
7 1 1 1
8 0 1 1
$EndNodes
$Elements
)";
  const BodyMesh cube = readGmsh(file("cube.msh", nodes + R"(3
1 5 2 1 1 5 6 7 8 1 2 3 4
2 3 2 2 2 1 2 3 4
3 3 2 3 3 2 3 7 6
$EndElements
)"),
                                 {{"cube", {"1"}}}, 3)
                            .front();
  EXPECT_NEAR(sizeOf(cube), 1.0, 1e-14);
  EXPECT_EQ(nodesOf(cube.mesh, cube.sides.at("2")), (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(nodesOf(cube.mesh, cube.sides.at("3")), (std::vector<int>{1, 2, 5, 6}));
  const BodyMesh corner =
      readGmsh(file("corner.msh", nodes + "1\n1 4 2 1 1 1 4 2 5\n$EndElements\n"), {{"corner", {"1"}}}, 3)
          .front();
  EXPECT_NEAR(sizeOf(corner), 1.0 / 6.0, 1e-14);
}

// Two triangles of one entity that go around in different ways, as .vtk files hold them.
TEST_F(GmshFile, turns_each_mirrored_cell) {
  const BodyMesh square = readGmsh(file("mixed.msh", R"($MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
4
1 0 0 0
2 1 0 0
3 0 1 0
4 1 1 0
$EndNodes
$Elements
2
1 2 2 1 1 1 2 3
2 2 2 1 1 2 3 4
$EndElements
)"),
                                   {{"all", {"1"}}}, 2)
                              .front();
  EXPECT_NEAR(sizeOf(square), 1.0, 1e-14);
  EXPECT_EQ(boundarySides(square.mesh).size(), 4u);
}

TEST_F(GmshFile, refuses_folded_meshes) {
  // The third node of the second triangle lies on the first one's side of their common edge, at (0.2, 0.2).
  const std::string text = refusalOf(file("folded.msh", R"($MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
4
1 0 0 0
2 1 0 0
3 0 1 0
4 0.2 0.2 0
$EndNodes
$Elements
2
1 2 2 1 1 1 2 3
2 2 2 1 1 2 3 4
$EndElements
)"),
                                     {{"all", {"1"}}});
  EXPECT_TRUE(contains(text, "body \"all\"") && contains(text, "folded")) << text;
  EXPECT_TRUE(contains(text, "with the corner nodes 1, 2, 3")) << text;
  EXPECT_TRUE(contains(text, "lie on the same side of their common face")) << text;
}

// In space, and where three cells share a face.
TEST_F(GmshFile, refuses_tetrahedra_that_cover_each_other) {
  const std::string nodes = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
6
1 0 0 0
2 1 0 0
3 0 1 0
4 0 0 1
5 0 0 -1
6 0.2 0.2 0.2
$EndNodes
$Elements
)";
  const std::string all = "$EndElements\n", first = "1 4 2 1 1 1 2 3 4\n", below = "2 4 2 1 1 1 2 3 5\n",
                    within = "3 4 2 1 1 1 2 3 6\n";
  EXPECT_NEAR(
      sizeOf(readGmsh(file("two.msh", nodes + "2\n" + first + below + all), {{"all", {"1"}}}, 3).front()),
      1.0 / 3.0, 1e-14);
  const std::string inside =
      refusalOf(file("inside.msh", nodes + "2\n" + first + within + all), {{"all", {"1"}}}, 3);
  EXPECT_TRUE(contains(inside, "folded")) << inside;
  const std::string third =
      refusalOf(file("third.msh", nodes + "3\n" + first + below + within + all), {{"all", {"1"}}}, 3);
  EXPECT_TRUE(contains(third, "folded")) << third;
}

// A second surface that is named and has no cells; and nothing says that the file is plane.
TEST_F(GmshFile, leaves_out_what_is_not_meshed) {
  const std::string path = file("empty.msh", R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
2
2 1 "plate"
2 2 "ghost"
$EndPhysicalNames
$Entities
0 0 2 0
1 0 0 0 1 1 0 1 1 0
2 0 0 0 1 1 0 1 2 0
$EndEntities
$Nodes
1 3 1 3
2 1 0 3
1
2
3
0 0 0
1 0 0
0 1 0
$EndNodes
$Elements
1 1 1 1
2 1 2 1
1 1 2 3
$EndElements
)");
  const std::vector<BodyMesh> bodies = readGmsh(path, {}, 0);
  ASSERT_EQ(bodies.size(), 1u);
  EXPECT_EQ(bodies.front().name, "plate");
  EXPECT_EQ(bodies.front().mesh.dimension(), 2);
  EXPECT_NEAR(sizeOf(readGmsh(path, {{"both", {"plate", "ghost"}}}, 2).front()), 0.5, 1e-14);
  const std::string text = refusalOf(path, {{"ghost", {"ghost"}}});
  EXPECT_TRUE(contains(text, "has no cells")) << text;
  const std::string flat = refusalOf(path, {{"plate", {"plate"}}}, 3);
  EXPECT_TRUE(contains(flat, "is a plane mesh of dimension 2")) << flat;
}

TEST_F(GmshFile, refuses_cells_of_no_size) {
  // The corners of the second triangle lie on a line, but for the rounding of their coordinates.
  const std::string text = refusalOf(file("flat.msh", R"($MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
5
1 0 0 0
2 1 0 0
3 0 1 0
4 0.1 0.3 0
5 0.2 0.6000000000000001 0
$EndNodes
$Elements
2
1 2 2 1 1 1 2 3
2 2 2 1 1 1 4 5
$EndElements
)"),
                                     {{"all", {"1"}}});
  EXPECT_TRUE(contains(text, "at (0, 0, 0) with the corner nodes 1, 4, 5 has no area")) << text;
}

// A curve between two regions of a body has no sides on its boundary, but nodes, which displacements may be
// prescribed at; between two bodies it is a boundary part of both.
TEST_F(GmshFile, groups_inside_a_body_name_nodes) {
  for (int order : {1, 2}) {
    const std::string name = file("disc.geo", discInSquare(false, order));
    const BodyMesh one = readGmsh(name, {{"plate", {"matrix", "inclusion"}}}, 2)[0];
    EXPECT_EQ(one.sides.count("circle"), 0u);
    ASSERT_EQ(one.nodes.count("circle"), 1u);
    const std::vector<BodyMesh> two = readGmsh(name, {{"matrix", {"matrix"}}, {"disc", {"inclusion"}}}, 2);
    const std::vector<int> onSides = fem::nodesOf(two[1].mesh, two[1].sides.at("circle"));
    EXPECT_EQ(one.nodes.at("circle").size(), onSides.size());
    EXPECT_EQ(two[1].nodes.count("circle"), 0u);
    for (int node : one.nodes.at("circle")) {
      const Point x = one.mesh.local(node);
      EXPECT_NEAR(std::hypot(x[0] - 1.0, x[1] - 1.0), 0.5, 1e-6) << order; // as exact as Gmsh's own nodes
    }
  }
}

} // namespace test_gmsh_file
