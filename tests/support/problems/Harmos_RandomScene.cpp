// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RandomScene.hpp"

#include "Harmos_Friction.hpp"
#include "Harmos_Log.hpp"

#include <cmath>
#include <random>

namespace Harmos {
namespace {

using fem::CellType;
using fem::Point;
using scene::Physics;

// Draws that are the same with every standard library, whose distributions are not.
class Draw {
 public:
  explicit Draw(unsigned seed) : engine_(seed) {}
  double within(double least, double most) { return least + (most - least) * unit(); }
  double logarithmic(double least, double most) {
    return std::pow(10.0, within(std::log10(least), std::log10(most)));
  }
  int integer(int least, int most) {
    return std::min(most, least + static_cast<int>(unit() * (most - least + 1)));
  }
  bool chance(double probability) { return unit() < probability; }
  template<class T>
  T one(const std::vector<T>& choices) {
    return choices[static_cast<std::size_t>(integer(0, static_cast<int>(choices.size()) - 1))];
  }

 private:
  double unit() { return static_cast<double>(engine_()) / 4294967296.0; }
  std::mt19937 engine_;
};

// What holds a body where the loads do not press it onto the next one.
enum class Hold {
  Full,     // every motion
  Sideways, // across the stack, and rotations
  None
};

struct Block {
  fem::StructuredBlock::Options options;
  fem::Material material;
  Hold hold = Hold::None;
  double friction = 0.0; // coefficient where it stands on the one below, or on the obstacle
};

class Generator {
 public:
  /// @param mostFriction 0: none.
  explicit Generator(unsigned seed, double mostFriction = 0.0) : draw_(seed), mostFriction_(mostFriction) {
    result_.seed = seed;
    result_.mostFriction = mostFriction;
  }

  RandomScene make() {
    drawPhysics();
    const int bodies = draw_.integer(1, 4);
    for (int b = 0; b < bodies; ++b)
      addBlock(b);
    buildBodies();
    holdBase();
    for (int b = 1; b < bodies; ++b)
      join(b);
    load();
    drawSettings();
    return std::move(result_);
  }

 private:
  // The same for the torn scene and the untorn one.
  template<class Function>
  void both(Function&& function) {
    function(result_.scene);
    function(result_.untorn);
  }

  void drawPhysics() {
    std::vector<Physics> choices = {Physics::Membrane,    Physics::PlaneStrain, Physics::PlaneStrain,
                                    Physics::PlaneStress, Physics::Solid,       Physics::Solid};
    if (mostFriction_ > 0.0)
      choices.erase(choices.begin());
    const Physics physics = draw_.one(choices);
    both([&](scene::Scene& scene) { scene.physics = physics; });
    isMembrane_ = physics == Physics::Membrane;
    dimension_ = physics == Physics::Solid ? 3 : 2;
    // Membranes touch along edges, and the edges may lie anywhere; bodies also stand on top of each other.
    axis_ = draw_.chance(0.5) ? 0 : static_cast<std::size_t>(dimension_) - 1;
    length_ = draw_.logarithmic(1e-3, 1e3);
  }

  // Boundary parts of blocks at the ends of a direction.
  std::string lowEnd(std::size_t direction) const {
    return direction == 0                                          ? "left"
           : direction + 1 == static_cast<std::size_t>(dimension_) ? "bottom"
                                                                   : "front";
  }
  std::string highEnd(std::size_t direction) const {
    return direction == 0 ? "right" : direction + 1 == static_cast<std::size_t>(dimension_) ? "top" : "back";
  }
  std::vector<std::size_t> across() const {
    std::vector<std::size_t> directions;
    for (std::size_t d = 0; d < static_cast<std::size_t>(dimension_); ++d)
      if (d != axis_)
        directions.push_back(d);
    return directions;
  }

  fem::Material drawMaterial() {
    const double contrast = mostFriction_ > 0.0 ? 1e2 : 1e6;
    const double young = draw_.logarithmic(1.0 / contrast, contrast);
    const double poisson = draw_.chance(0.3) ? 0.5 - draw_.logarithmic(1e-4, 1e-1) : draw_.within(0.0, 0.4);
    fem::Material material = fem::Material::isotropic(young, poisson);
    if (draw_.chance(0.2)) { // fibres
      material.young[0] *= draw_.within(1.0, 10.0);
      material.poisson = {0.3, 0.3, 0.3};
      material.angle = draw_.within(0.0, 3.0);
    }
    const double expansion = draw_.logarithmic(1e-6, 1e-4);
    material.expansion = {expansion, expansion, expansion};
    return material;
  }

  void addBlock(int b) {
    Block block;
    const bool matches = b > 0 && draw_.chance(0.5); // the mesh of the block below
    fem::StructuredBlock::Options& options = block.options;
    if (matches) {
      options = blocks_.back().options;
    } else {
      options.cellType =
          dimension_ == 3
              ? draw_.one<CellType>({CellType::Hexahedron8, CellType::Hexahedron8, CellType::Tetrahedron4,
                                     CellType::Hexahedron27, CellType::Tetrahedron10})
              : draw_.one<CellType>({CellType::Quadrilateral4, CellType::Quadrilateral4, CellType::Triangle3,
                                     CellType::Quadrilateral9, CellType::Triangle6});
      const bool isQuadratic = fem::shapeOf(options.cellType).order == 2;
      for (std::size_t d : across()) {
        options.size[d] = length_ * draw_.within(0.5, 2.0);
        options.origin[d] = -0.5 * options.size[d];
        options.subdomains[d] = draw_.integer(1, dimension_ == 3 ? 2 : 3);
        options.elements[d] = draw_.integer(1, isQuadratic || dimension_ == 3 ? 2 : 4);
      }
    }
    // Tetrahedra of ten nodes cannot be the first surface of mortar coupling: of two blocks that do not match
    // one has to have other cells.
    if (b > 0 && !matches && options.cellType == CellType::Tetrahedron10 &&
        blocks_.back().options.cellType == CellType::Tetrahedron10)
      options.cellType = CellType::Hexahedron27;
    const bool isQuadratic = fem::shapeOf(options.cellType).order == 2;
    options.size[axis_] = length_ * (draw_.chance(0.1) ? draw_.within(0.02, 0.1) : draw_.within(0.3, 1.5));
    options.origin[axis_] = height_;
    height_ += options.size[axis_];
    options.subdomains[axis_] = draw_.integer(1, 2);
    options.elements[axis_] = draw_.integer(1, isQuadratic || dimension_ == 3 ? 2 : 4);
    block.material = drawMaterial();
    blocks_.push_back(block);
  }

  void buildBodies() {
    if (isMembrane_)
      for (Block& block : blocks_)
        block.material = {};
    both([&](scene::Scene& scene) {
      long long firstNode = 0;
      const bool isTorn = &scene == &result_.scene;
      for (std::size_t b = 0; b < blocks_.size(); ++b) {
        fem::StructuredBlock::Options options = blocks_[b].options;
        options.firstNode = firstNode;
        if (!isTorn)
          for (std::size_t d = 0; d < 3; ++d) {
            options.elements[d] *= options.subdomains[d];
            options.subdomains[d] = 1;
          }
        scene::Body body = blockBody("block" + std::to_string(b), options, blocks_[b].material);
        firstNode = options.firstNode;
        if (fem::nearlyIncompressible(blocks_[b].material))
          body.dilatation = fem::Dilatation::Projected;
        scene.bodies.push_back(body);
      }
    });
  }

  void prescribeBoth(std::size_t body, const std::string& set, std::size_t component, double value) {
    isHeldAnywhere_[body] = true;
    both([&](scene::Scene& scene) {
      prescribe(scene, {static_cast<int>(body), set}, static_cast<int>(component), value);
    });
  }

  void holdSideways(std::size_t b) {
    for (std::size_t d : across())
      prescribeBoth(b, lowEnd(d), d, 0.0);
    blocks_[b].hold = Hold::Sideways;
  }

  // A distance of the size of displacements and gaps.
  double smallLength() { return length_ * draw_.logarithmic(1e-6, 1e-2); }

  void holdBase() {
    isHeldAnywhere_.assign(blocks_.size(), false);
    if (isMembrane_ || draw_.chance(0.65)) {
      const double value = draw_.chance(0.2) ? smallLength() : 0.0;
      for (std::size_t d = 0; d < (isMembrane_ ? 1 : static_cast<std::size_t>(dimension_)); ++d)
        prescribeBoth(0, lowEnd(axis_), d, d == 0 ? value : 0.0);
      blocks_[0].hold = Hold::Full;
      return;
    }
    contact::Obstacle obstacle;
    obstacle.direction[axis_] = 1.0;
    const double gap = draw_.one<double>({0.0, 1.0, -1.0}) * smallLength();
    obstacle.point[axis_] = -gap;
    if (draw_.chance(0.6))
      holdSideways(0);
    if (blocks_[0].hold == Hold::Sideways && draw_.chance(0.4)) {
      // A ball or a roller below the base.
      const double radius = length_ * draw_.within(0.5, 5.0);
      obstacle.shape = draw_.chance(0.5) || dimension_ == 2 ? contact::Obstacle::Shape::Cylinder
                                                            : contact::Obstacle::Shape::Sphere;
      obstacle.direction = {};
      obstacle.direction[dimension_ == 2 ? 2 : across().back()] = 1.0;
      obstacle.radius = radius;
      obstacle.point[axis_] -= radius;
    }
    isOnContact_ = true;
    both([&](scene::Scene& scene) { addObstacle(scene, {0, lowEnd(axis_)}, obstacle); });
    rub(0);
  }

  // Friction on the contact that was added last, below a block.
  void rub(std::size_t b) {
    if (mostFriction_ <= 0.0 || !draw_.chance(0.9))
      return;
    if (draw_.chance(0.15)) {
      const double slipBound = blocks_[b].material.young[0] * draw_.logarithmic(1e-6, 1e-2);
      both([&](scene::Scene& scene) {
        scene.effects.push_back(std::make_shared<effects::Friction>(scene.effects.back(), slipBound));
      });
      return;
    }
    blocks_[b].friction = draw_.logarithmic(0.02 * mostFriction_, mostFriction_);
    both([&](scene::Scene& scene) {
      scene.effects.push_back(
          std::make_shared<effects::Friction>(scene.effects.back(), effects::Coulomb(blocks_[b].friction)));
    });
  }

  void join(int b) {
    const auto upper = static_cast<std::size_t>(b);
    Part below{b - 1, highEnd(axis_)}, above{b, lowEnd(axis_)};
    const auto isFit = [&](const Part& part) {
      return blocks_[static_cast<std::size_t>(part.body)].options.cellType != CellType::Tetrahedron10;
    };
    const bool isTie = draw_.chance(0.3);
    // u¹ − u² ≤ gap of membranes has a direction: the upper one is pressed down onto the lower one.
    if (isMembrane_ && !isTie ? false : draw_.chance(0.5))
      std::swap(below, above);
    if (!isFit(below))
      std::swap(below, above);
    if (isTie) {
      both([&](scene::Scene& scene) { addTie(scene, below, above); });
      blocks_[upper].hold = blocks_[upper - 1].hold;
      blocks_[upper].friction = tied;
      return;
    }
    const double gap = draw_.one<double>({0.0, 0.0, 1.0, -1.0}) * smallLength();
    both([&](scene::Scene& scene) { addContact(scene, below, above, gap); });
    isOnContact_ = true;
    rub(upper);
    if (!isMembrane_ && draw_.chance(0.6))
      holdSideways(upper);
  }

  // Sideways by so much of what presses down on the topmost body.
  void drawPush() {
    const std::size_t top = blocks_.size() - 1;
    if (mostFriction_ <= 0.0 || blocks_[top].hold == Hold::Full || !draw_.chance(0.7))
      return;
    double share = 1.0;
    if (blocks_[top].hold == Hold::None) {
      // Each body that nothing else holds hands it down to the next one.
      for (std::size_t b = top + 1; b-- > 0 && blocks_[b].hold == Hold::None;)
        share = std::min(share, 0.5 * blocks_[b].friction);
      for (const Block& block : blocks_)
        for (std::size_t d : across())
          share = std::min(share, 0.1 * block.options.size[d] / height_);
      if (blocks_[top].friction > 0.0 && blocks_[top].friction < tied && draw_.chance(0.2)) {
        share = 2.0 * blocks_[top].friction;
        result_.isSolvable = false;
      }
    } else {
      share *= draw_.within(-1.0, 1.0);
    }
    push_[draw_.one(across())] = share;
  }

  // A push towards the base, or anywhere where the body is held.
  Point drawDensity(std::size_t b, double size) {
    Point density{};
    if (isMembrane_) {
      density[0] = -size;
    } else if (blocks_[b].hold == Hold::Full) {
      for (std::size_t d = 0; d < static_cast<std::size_t>(dimension_); ++d)
        density[d] = size * draw_.within(-1.0, 1.0);
    } else {
      density[axis_] = -size;
      if (b + 1 == blocks_.size())
        for (std::size_t d : across())
          density[d] = size * push_[d];
    }
    return density;
  }

  void addForceBoth(std::size_t b, const Point& density) {
    both([&](scene::Scene& scene) {
      if (isMembrane_)
        addMembraneLoad(scene, b, density[0]);
      else
        addForce(scene, static_cast<int>(b), density);
    });
  }

  // Over the whole of it, whatever the rounding at its edges.
  void addMembraneLoad(scene::Scene& scene, std::size_t b, double density) const {
    const fem::StructuredBlock::Options& options = blocks_[b].options;
    const std::vector<fem::BoxLoad> loads = {
        {density,
         {options.origin[0] - length_, options.origin[1] - length_},
         {options.origin[0] + options.size[0] + length_, options.origin[1] + options.size[1] + length_}}};
    addForce(scene, static_cast<int>(b), loads);
  }

  void load() {
    const std::size_t top = blocks_.size() - 1;
    drawPush();
    // Of the size that some body of the stack bears; others may be softer or stiffer by far.
    const double young =
        blocks_[static_cast<std::size_t>(draw_.integer(0, static_cast<int>(top)))].material.young[0];
    const double stress = young * draw_.logarithmic(1e-5, 1e-2);
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const fem::Material& material = blocks_[b].material;
      if (draw_.chance(0.5) || (isMembrane_ && b == top))
        addForceBoth(b, drawDensity(b, stress * draw_.within(0.01, 1.0) / length_));
      if (!isMembrane_ && draw_.chance(0.2)) {
        const double strain = stress * draw_.within(-1.0, 1.0) / material.young[0];
        both([&](scene::Scene& scene) {
          addTemperature(scene, static_cast<int>(b), strain / material.expansion[0]);
        });
      }
    }
    if (!isMembrane_) {
      const Point density = drawDensity(top, stress);
      both([&](scene::Scene& scene) {
        addTraction(scene, {static_cast<int>(top), highEnd(axis_)}, density);
      });
    }
    if (!isOnContact_ || blocks_[top].hold == Hold::Full ||
        (push_ != Point{} && blocks_[top].hold == Hold::None))
      return;
    if (draw_.chance(0.2)) { // pressed down by its far end
      prescribeBoth(top, highEnd(axis_), isMembrane_ ? 0 : axis_, -smallLength());
    } else if (draw_.chance(0.12)) { // pulled away, by more than everything else together presses it down
      Point density{};
      double stiff = 0.0;
      for (const Block& block : blocks_)
        stiff = std::max(stiff, block.material.young[0]);
      density[isMembrane_ ? 0 : axis_] = 100.0 * stiff / length_;
      addForceBoth(top, density);
      result_.isSolvable = false;
    }
  }

  void drawSettings() {
    std::vector<std::string>& settings = result_.settings;
    const auto set = [&](const std::string& name, const std::vector<std::string>& choices) {
      settings.push_back(name + "=" + draw_.one(choices));
      return settings.back().substr(name.size() + 1);
    };
    result_.tolerance = draw_.logarithmic(1e-10, 1e-2);
    const std::string form = set("Dual operator/Form", {"auto", "implicit", "condensed"});
    set("Dual operator/Preconditioner", {"Dirichlet", "Dirichlet", "Dirichlet", "lumped", "lumped", "none"});
    set("Dual operator/Expert/Scaling", {"auto", "auto", "multiplicity", "stiffness"});
    set("Dual operator/Expert/Share identical subdomains", {"true", "true", "false"});
    // Dense blocks in single precision reach 1e-6, and not even that where subdomains are badly conditioned
    // themselves: those are refused.
    bool isWellConditioned = true;
    for (const Block& block : blocks_)
      isWellConditioned = isWellConditioned && block.options.size[axis_] > 0.1 * length_ &&
                          !fem::nearlyIncompressible(block.material);
    if ((result_.tolerance > 1e-6 || form == "implicit") && (isWellConditioned || draw_.chance(0.1)))
      set("Dual operator/Precision", {"double", "double", "double", "single"});
    const bool isTotal = set("Decomposition/Dirichlet", {"primal", "dual"}) == "dual";
    set("Solver/Stopping rule", {"scaled", "scaled", "scaled", "paper", "permon"});
    set("Solver/Expert/Initial guess", {"zero", "zero", "half load"});
    // Those that the problem admits: with a floating subdomain there are equalities, with contact bounds.
    std::vector<std::string> methods = {"Auto", "Auto"};
    bool floats = isTotal, mayFloat = false;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      floats = floats || !isHeldAnywhere_[b];
      mayFloat = mayFloat || result_.scene.bodies[b].subdomains > 1 || blocks_[b].hold != Hold::Full;
    }
    if (isOnContact_)
      methods.insert(methods.end(), {"PDAS", "PDAS"});
    if (isOnContact_ && floats)
      methods.insert(methods.end(), {"SMALBE", "SMALBE"});
    if (isOnContact_ && !floats && !mayFloat)
      methods.push_back("MPRGP");
    if (!isOnContact_ && floats)
      methods.push_back("PCPG");
    set("Solver/Method", methods);
    settings.push_back("Solver/Maximum iterations=10000");
  }

  static constexpr double tied = 1e300; // a coefficient that ties have

  Draw draw_;
  double mostFriction_;
  Point push_{}; // over what presses down, of the topmost body
  RandomScene result_;
  std::vector<Block> blocks_;
  std::vector<bool> isHeldAnywhere_;
  bool isMembrane_ = false;
  bool isOnContact_ = false;
  int dimension_ = 2;
  std::size_t axis_ = 0;
  double length_ = 1.0;
  double height_ = 0.0;
};

} // namespace

RandomScene randomScene(unsigned seed) {
  return Generator(seed).make();
}

RandomScene randomFrictionScene(unsigned seed, double most) {
  return Generator(seed, most).make();
}

std::string RandomScene::text() const {
  static const char* const names[] = {"membrane", "plane strain", "plane stress", "axisymmetric", "solid"};
  std::string line = "seed " + std::to_string(seed) + ": " + names[static_cast<int>(scene.physics)] + ", " +
                     std::to_string(scene.bodies.size()) + " bodies, " + std::to_string(scene.subdomains()) +
                     " subdomains, tolerance " + scientific(tolerance, 1);
  for (const std::string& setting : settings)
    line += ", " + setting.substr(setting.find('/') + 1);
  return line;
}

} // namespace Harmos
