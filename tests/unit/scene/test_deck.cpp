// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Deck.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_RunOptions.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"
#include "Harmos_TestScene.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <unistd.h>

namespace test_deck {

using namespace Harmos;

namespace {

// A file that lives as long as the test; written by rank 0, which alone reads it.
class DeckFile {
 public:
  DeckFile(const std::string& name, const std::string& text)
      : path_("/tmp/harmos_test_" + std::to_string(getpid()) + "_" + name) {
    if (testComm()->getRank() == 0)
      std::ofstream(path_) << text;
  }
  ~DeckFile() {
    if (testComm()->getRank() == 0)
      std::remove(path_.c_str());
  }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

ParameterSpec spec() {
  ParameterSpec result("test", "A deck.");
  run::RunOptions::addTo(result);
  return result;
}

std::string failure(const DeckFile& file, const std::vector<std::string>& assignments = {}) {
  return inputErrorOf([&] { scene::readDeck(*testComm(), file.path(), assignments, spec()); });
}

} // namespace

TEST(Deck, xml_and_yaml_give_the_same_on_all_ranks) {
  const DeckFile xml("a.xml",
                     "<ParameterList><ParameterList name=\"Solver\"><Parameter name=\"Tolerance\" "
                     "type=\"double\" value=\"0.1234567890123456789\"/></ParameterList></ParameterList>");
  const DeckFile yaml("a.yaml", "test:\n  Solver:\n    Tolerance: 0.1234567890123456789\n");
  for (const DeckFile* file : {&xml, &yaml}) {
    const auto deck = scene::readDeck(*testComm(), file->path(), {}, spec());
    // Every bit survives the way to the other ranks.
    EXPECT_EQ(deck.sublist("Solver").get<double>("Tolerance"), 0.1234567890123456789);
    EXPECT_EQ(run::RunOptions::fromDeck(deck).method, "Auto");
  }
}

TEST(Deck, assignments_win_in_their_order) {
  const DeckFile xml("b.xml", "<ParameterList/>");
  const auto deck =
      scene::readDeck(*testComm(), xml.path(),
                      {"Solver/Tolerance=1e-2", "Solver/Tolerance=1e-3", "Output/Fields=false"}, spec());
  EXPECT_EQ(deck.sublist("Solver").get<double>("Tolerance"), 1e-3);
  EXPECT_FALSE(deck.sublist("Output").get<bool>("Fields"));
}

TEST(Deck, faults_are_thrown_on_all_ranks) {
  EXPECT_TRUE(
      contains(failure(DeckFile("c.xml", "<ParameterList><Parameter name=\"Solver\"</ParameterList>")),
               "is not a well-formed ParameterList"));
  EXPECT_TRUE(contains(failure(DeckFile("d.xml", "")), "is not a well-formed ParameterList"));
  EXPECT_TRUE(
      contains(failure(DeckFile("e.xml", "<ParameterList/>"), {"Solver/Tolerance"}), "is not of the form"));
  EXPECT_TRUE(contains(failure(DeckFile("f.xml", "<ParameterList/>"), {"Solver/Tol=1"}), "did you mean"));
  try {
    scene::readDeck(*testComm(), "/nowhere/deck.xml", {}, spec());
    FAIL() << "nothing was thrown";
  } catch (const InputError& error) {
    EXPECT_TRUE(contains(error.what(), "No such file"));
  }
}

// Teuchos takes what it does not understand in an array for 0.
TEST(Deck, arrays_are_read_as_a_whole_or_not_at_all) {
  const auto deck = [](const std::string& value) {
    return DeckFile("g.xml", "<ParameterList><ParameterList name=\"Steps\"><Parameter name=\"Times\" "
                             "type=\"Array(double)\" value=\"" +
                                 value + "\"/></ParameterList></ParameterList>");
  };
  for (const char* value :
       {"{-inf,1}", "{nan,1}", "{x,1}", "{1e,1}", "{0,1.0.5}", "{0,1 2}", "{0,}", "0,1", "{0,1"})
    EXPECT_TRUE(contains(failure(deck(value)), "is not a valid value of that type")) << value;
  for (const char* value : {"{1,2}", "{ 1.5 , 2e3 }", " {1}", "{}"})
    EXPECT_FALSE(contains(failure(deck(value)), "is not a valid value of that type")) << value;
}

TEST(Deck, contradictions_are_refused) {
  scene::Scene scene;
  scene.bodies.resize(2);
  prescribe(scene, {0, "left"}, 0);
  addContact(scene, {0, "right"}, {1, "left"});
  Teuchos::ParameterList deck = spec().defaults();
  const auto attempt = [&](const std::string& method) {
    deck.sublist("Solver").set("Method", method);
    try {
      run::checkConsistency(scene, run::RunOptions::fromDeck(deck));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(attempt("Auto"), "");
  EXPECT_TRUE(contains(attempt("PCPG"), "without inequalities"));
  EXPECT_TRUE(contains(attempt("MPRGP"), "a body without a prescribed displacement"));
  prescribe(scene, {1, "right"}, 0);
  EXPECT_EQ(attempt("MPRGP"), "");
  deck.sublist("Decomposition").set("Dirichlet", std::string("dual"));
  EXPECT_TRUE(contains(attempt("MPRGP"), "every subdomain floats"));
  removeEffects(scene, "Contact");
  addTie(scene, {0, "right"}, {1, "left"});
  EXPECT_EQ(attempt("PCPG"), "");
}

} // namespace test_deck
