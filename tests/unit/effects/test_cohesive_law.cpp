// SPDX-License-Identifier: BSD-3-Clause

/// The law of an interface at one point: its curve and the energy under it, in each mode and in mixtures;
/// what no path may do.

#include "Harmos_CohesiveLaw.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>

namespace test_cohesive_law {

using namespace Harmos;
using effects::CohesiveLaw;

namespace {

using Options = CohesiveLaw::Options;

Options usual() {
  Options options;
  options.normalStiffness = 1e4;
  options.tangentialStiffness = 3e3;
  options.normalStrength = 20.0;
  options.tangentialStrength = 12.0;
  options.fractureEnergy = 0.3;
  options.fractureEnergyII = 0.9;
  return options;
}

// e = √(2Y) and the share of mode II, by what Y is.
CohesiveLaw::Opening openingOf(const CohesiveLaw& law, double normal, double tangential) {
  const double open = std::max(0.0, normal);
  const double ofNormal = law.options().normalStiffness * open * open,
               ofSlip = law.options().tangentialStiffness * tangential * tangential;
  return {std::sqrt(ofNormal + ofSlip), ofSlip > 0.0 ? ofSlip / (ofNormal + ofSlip) : 0.0};
}

// Traction along the direction of the opening, of a point that goes straight there: its energy by area and
// length of the path is that of both directions.
double pull(const CohesiveLaw& law, double angle, double length) {
  const double normal = length * std::cos(angle), tangential = length * std::sin(angle);
  const double left = 1.0 - law.damage(openingOf(law, normal, tangential));
  return left * (law.options().normalStiffness * normal * std::cos(angle) +
                 law.options().tangentialStiffness * tangential * std::sin(angle));
}

// Simpson's rule, exact for the straight pieces.
double integral(const CohesiveLaw& law, double angle, double from, double to) {
  constexpr int pieces = 2000;
  const double step = (to - from) / pieces;
  double sum = 0.0;
  for (int k = 0; k < pieces; ++k) {
    const double a = from + k * step;
    sum += step / 6.0 *
           (pull(law, angle, a) + 4.0 * pull(law, angle, a + 0.5 * step) + pull(law, angle, a + step));
  }
  return sum;
}

// Of an opening of length one.
CohesiveLaw::Opening unit(const CohesiveLaw& law, double angle) {
  return openingOf(law, std::cos(angle), std::sin(angle));
}

constexpr double quarter = 1.5707963267948966;

} // namespace

// The area under the curve, in both modes and between them, is the fracture energy: that which was given, or
// that of the formula, written down here once more. Both of them agree where the exponents are one.
TEST(CohesiveLaw, the_area_is_the_fracture_energy) {
  for (const double exponent : {0.7, 1.0, 2.3})
    for (const bool isPower : {true, false}) {
      Options options = usual();
      options.exponent = exponent;
      options.mixedMode = isPower ? CohesiveLaw::MixedMode::Power : CohesiveLaw::MixedMode::BenzeggaghKenane;
      const CohesiveLaw law(options);
      for (const double angle : {0.0, 0.3, 0.8, 1.2, quarter}) {
        const CohesiveLaw::Opening way = unit(law, angle);
        const double tangential = std::pow(std::sin(angle), 2) * options.tangentialStiffness;
        const double share =
            tangential / (tangential + std::pow(std::cos(angle), 2) * options.normalStiffness);
        EXPECT_NEAR(way.share, share, 1e-14);
        double expected = options.fractureEnergy +
                          (options.fractureEnergyII - options.fractureEnergy) * std::pow(share, exponent);
        if (isPower)
          expected = 1.0 / std::pow(std::pow((1.0 - share) / options.fractureEnergy, exponent) +
                                        std::pow(share / options.fractureEnergyII, exponent),
                                    1.0 / exponent);
        if (angle == 0.0)
          expected = 0.3;
        if (angle == quarter)
          expected = 0.9;
        // From 0 to where it begins, and on to the end, which is told apart to 1e-9.
        const double first = law.onset(share) / way.size, last = law.end(share) / way.size;
        const double area = integral(law, angle, 0.0, first) + integral(law, angle, first, last);
        EXPECT_NEAR(area, expected, 1e-10 * expected) << angle << exponent << isPower;
        EXPECT_NEAR(law.dissipated(1.0, share), expected, 1e-12 * expected);
        EXPECT_NEAR(pull(law, angle, 1.01 * last), 0.0, 0.0);
      }
    }
}

// The largest traction is the strength, in both modes; in between the quadratic criterion holds.
TEST(CohesiveLaw, it_begins_at_the_strength) {
  for (const auto kind : {CohesiveLaw::Kind::Bilinear, CohesiveLaw::Kind::Brittle}) {
    Options options = usual();
    options.kind = kind;
    const CohesiveLaw law(options);
    for (const double angle : {0.0, 0.5, 1.1, quarter}) {
      const double most = law.onset(unit(law, angle).share) / unit(law, angle).size;
      const double tn = options.normalStiffness * most * std::cos(angle) / options.normalStrength,
                   tt = options.tangentialStiffness * most * std::sin(angle) / options.tangentialStrength;
      EXPECT_NEAR(tn * tn + tt * tt, 1.0, 1e-13);
      EXPECT_EQ(law.damage(openingOf(law, 0.999 * most * std::cos(angle), 0.999 * most * std::sin(angle))),
                0.0);
      const double beyond =
          law.damage(openingOf(law, 1.001 * most * std::cos(angle), 1.001 * most * std::sin(angle)));
      if (kind == CohesiveLaw::Kind::Brittle)
        EXPECT_EQ(beyond, 1.0);
      else
        EXPECT_GT(beyond, 0.0);
      EXPECT_LE(pull(law, angle, 1.001 * most), pull(law, angle, most));
    }
    EXPECT_NEAR(pull(law, 0.0, options.normalStrength / options.normalStiffness), 20.0, 1e-11);
    EXPECT_NEAR(pull(law, quarter, options.tangentialStrength / options.tangentialStiffness), 12.0, 1e-11);
  }
}

// What is dissipated up to a damage is the area under the curve up to there less what unloading, straight to
// the origin, gives back.
TEST(CohesiveLaw, unloading_goes_to_the_origin) {
  const CohesiveLaw law(usual());
  for (const double angle : {0.0, 0.8, quarter}) {
    const CohesiveLaw::Opening way = unit(law, angle);
    const double first = law.onset(way.share) / way.size, last = law.end(way.share) / way.size;
    for (const double part : {0.1, 0.5, 0.9}) {
      const double length = first + part * (last - first);
      const double damage = law.damage({length * way.size, way.share});
      const double area = integral(law, angle, 0.0, first) + integral(law, angle, first, length);
      const double back = 0.5 * (1.0 - damage) * std::pow(length * way.size, 2);
      EXPECT_NEAR(0.5 * pull(law, angle, length) * length, back, 1e-12 * area);
      EXPECT_NEAR(law.dissipated(damage, way.share), area - back, 1e-10 * area);
      EXPECT_NEAR(law.sizeAt(damage, way.share), length * way.size, 1e-10 * length * way.size);
    }
  }
}

// Along random paths damage that is never let fall stays between zero and one, and what is dissipated, sum of
// the energies that its growth releases, never falls; nor is it less than the lesser fracture energy where
// the point has broken, nor more than the larger one.
TEST(CohesiveLaw, random_paths) {
  const Options options = usual();
  const CohesiveLaw law(options);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> part(-1.0, 1.0);
  for (int path = 0; path < 50; ++path) {
    double damage = 0.0, dissipated = 0.0, normal = 0.0, tangential = 0.0;
    for (int step = 0; step < 20000 && damage < 1.0; ++step) {
      const double outwards = step < 10000 ? 0.0 : 0.1; // to an end at last
      normal += 1e-3 * (part(random) + outwards);
      tangential += 1e-3 * part(random);
      const CohesiveLaw::Opening opening = openingOf(law, normal, std::abs(tangential));
      const double now = law.damage(opening);
      EXPECT_TRUE(now >= 0.0 && now <= 1.0);
      if (now <= damage)
        continue;
      const double more = law.dissipated(now, opening.share) - law.dissipated(damage, opening.share);
      EXPECT_GE(more, 0.0);
      dissipated += more;
      damage = now;
    }
    EXPECT_EQ(damage, 1.0) << "the path is too short for this test";
    EXPECT_GT(dissipated, options.fractureEnergy * (1.0 - 1e-9));
    EXPECT_LT(dissipated, options.fractureEnergyII * (1.0 + 1e-9));
  }
}

// Energies that springs store before they give way are too small; the least admissible one is told, and a bit
// more is enough.
TEST(CohesiveLaw, laws_that_would_snap_are_refused) {
  const auto refusal = [](const Options& options) { return inputErrorOf([&] { CohesiveLaw law(options); }); };
  Options options = usual();
  EXPECT_EQ(refusal(options), "");
  options.fractureEnergy = 0.5 * 20.0 * 20.0 / 1e4 * (1.0 - 1e-6); // σ²/2k_n
  EXPECT_TRUE(contains(refusal(options), "Fracture energy")) << refusal(options);
  EXPECT_TRUE(contains(refusal(options), "2.0000e-02")) << refusal(options);
  EXPECT_TRUE(contains(refusal(options), "the law snap back")) << refusal(options);
  options.fractureEnergy *= 1.0 + 3e-6;
  EXPECT_EQ(refusal(options), "");
  options.fractureEnergyII = 0.5 * 12.0 * 12.0 / 3e3 * (1.0 - 1e-6);
  EXPECT_TRUE(contains(refusal(options), "Fracture energy II")) << refusal(options);
  EXPECT_TRUE(contains(refusal(options), "2.4000e-02")) << refusal(options);
  // By a power below one mixtures need less than either mode, and what they store is no less.
  options = usual();
  options.fractureEnergy = 0.024;
  options.fractureEnergyII = 0.029;
  EXPECT_EQ(refusal(options), "");
  options.exponent = 0.5;
  const std::string text = refusal(options);
  EXPECT_TRUE(contains(text, "where both modes act")) << text;
  // What it says is enough, and only just.
  double worst = 0.0;
  for (int k = 0; k <= 100000; ++k) {
    const double share = k / 100000.0;
    const double criterion = (1.0 - share) * 1e4 / 400.0 + share * 3e3 / 144.0;
    const double energy = std::pow(std::sqrt((1.0 - share) / 0.024) + std::sqrt(share / 0.029), -2.0);
    worst = std::max(worst, 0.5 / criterion / energy);
  }
  for (const double factor : {worst * (1.0 - 1e-4), worst * (1.0 + 1e-4)}) {
    options.fractureEnergy = 0.024 * factor;
    options.fractureEnergyII = 0.029 * factor;
    EXPECT_EQ(refusal(options).empty(), factor > worst) << factor;
  }
}

TEST(CohesiveLaw, numbers_that_make_no_sense_are_refused) {
  const auto refusal = [](double Options::*member, double value, CohesiveLaw::Kind kind) {
    Options options = usual();
    options.kind = kind;
    options.*member = value;
    return inputErrorOf([&] { CohesiveLaw law(options); });
  };
  using Kind = CohesiveLaw::Kind;
  const std::array<std::pair<double Options::*, std::string>, 7> all = {
      {{&Options::normalStiffness, "\"Normal stiffness\""},
       {&Options::tangentialStiffness, "\"Tangential stiffness\""},
       {&Options::normalStrength, "\"Normal strength\""},
       {&Options::tangentialStrength, "\"Tangential strength\""},
       {&Options::fractureEnergy, "\"Fracture energy\""},
       {&Options::fractureEnergyII, "\"Fracture energy II\""},
       {&Options::exponent, "\"Mixed mode exponent\""}}};
  for (std::size_t k = 0; k < all.size(); ++k)
    for (const double value : {0.0, -1.0, std::nan("")}) {
      EXPECT_TRUE(contains(refusal(all[k].first, value, Kind::Bilinear), all[k].second)) << all[k].second;
      EXPECT_EQ(refusal(all[k].first, value, Kind::Brittle).empty(), k >= 4) << all[k].second;
    }
}

} // namespace test_cohesive_law
