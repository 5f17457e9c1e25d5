// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_ParameterSpec.hpp"

#include "Harmos_TestErrors.hpp"
#include <Teuchos_XMLParameterListCoreHelpers.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

namespace test_expert_parameters {

using namespace Harmos;

namespace {

ParameterSpec deck() {
  ParameterSpec solver("Solver", "The solver.");
  solver.real("Tolerance", 1e-4, Range::strictlyWithin(0.0, 1.0), "Relative tolerance. Of the residual.");
  solver.expert().choice("Initial guess", "zero", {{"zero", "none"}, {"half load", "half of it"}},
                         "First iterate.");
  ParameterSpec pdas("PDAS", "Active sets.");
  pdas.integer("Most", 200, 1, 1000, "Most of them.").real("Reduction", 0.5, Range(), "Of the residual.");
  solver.expert().list(pdas);
  ParameterSpec body("<body>", "A body. Of any name.");
  body.reals("Size", {1.0, 1.0}, Range::above(0.0), "Its sides.");
  body.expert().integer("Seed", 1, 0, 9, "Of random numbers.");
  ParameterSpec bodies("Bodies", "All bodies.");
  bodies.family(body);
  ParameterSpec spec("deck", "A deck.");
  spec.list(solver).list(bodies);
  return spec;
}

const std::string still = "; this version still reads the old place";

struct Read {
  Teuchos::ParameterList list;
  std::vector<std::string> notes;
};

Read read(const Teuchos::ParameterList& list) {
  Read result;
  result.list = deck().validated(list, "deck.xml", &result.notes);
  return result;
}

std::string message(const Teuchos::ParameterList& list) {
  return inputErrorOf([&] { deck().validated(list, "deck.xml"); });
}

std::string refused(const std::string& path, const std::string& value) {
  Teuchos::ParameterList list;
  return inputErrorOf([&] { deck().set(list, path, value, "--set"); });
}

} // namespace

TEST(ExpertParameters, defaults_are_in_the_sublist) {
  const Teuchos::ParameterList list = deck().defaults().sublist("Solver");
  EXPECT_FALSE(list.isParameter("Initial guess"));
  EXPECT_EQ(list.sublist("Expert").get<std::string>("Initial guess"), "zero");
  EXPECT_EQ(list.sublist("Expert").sublist("PDAS").get<int>("Most"), 200);
  EXPECT_TRUE(deck().teuchosList()->sublist("Solver").isSublist("Expert"));
}

TEST(ExpertParameters, the_old_place_is_read_with_a_note) {
  Teuchos::ParameterList old;
  old.sublist("Solver").set("Initial guess", "half load").sublist("PDAS").set("Most", 3);
  old.sublist("Bodies").sublist("wheel").set("Seed", 2);
  const Read found = read(old);
  Teuchos::ParameterList now;
  now.sublist("Solver").sublist("Expert").set("Initial guess", "half load").sublist("PDAS").set("Most", 3);
  now.sublist("Bodies").sublist("wheel").sublist("Expert").set("Seed", 2);
  const Read same = read(now);
  EXPECT_TRUE(Teuchos::haveSameValues(found.list, same.list));
  EXPECT_TRUE(same.notes.empty());
  EXPECT_EQ(found.list.sublist("Solver").sublist("Expert").sublist("PDAS").get<double>("Reduction"), 0.5);
  std::vector<std::string> notes = found.notes;
  std::sort(notes.begin(), notes.end());
  EXPECT_EQ(notes, (std::vector<std::string>{
                       "\"Bodies/wheel/Seed\" is now \"Bodies/wheel/Expert/Seed\"" + still,
                       "\"Solver/Initial guess\" is now \"Solver/Expert/Initial guess\"" + still,
                       "\"Solver/PDAS\" is now \"Solver/Expert/PDAS\"" + still}));
}

TEST(ExpertParameters, validated_lists_stay_as_they_are) {
  Teuchos::ParameterList old;
  old.sublist("Solver").sublist("PDAS").set("Most", 3);
  const Read once = read(old), twice = read(once.list);
  EXPECT_TRUE(Teuchos::haveSameValues(once.list, twice.list));
  EXPECT_TRUE(twice.notes.empty());
}

TEST(ExpertParameters, both_places_must_agree) {
  Teuchos::ParameterList list;
  list.sublist("Solver").sublist("PDAS").set("Most", 3).set("Reduction", 0.25);
  list.sublist("Solver").sublist("Expert").sublist("PDAS").set("Most", 4).set("Reduction", 0.25);
  EXPECT_EQ(message(list),
            "deck.xml: \"Solver/PDAS/Most\" is an integer (3), but \"Solver/Expert/PDAS/Most\" is an "
            "integer (4); keep the second, which is its present place");
  list.sublist("Solver").sublist("PDAS").set("Most", 4);
  EXPECT_EQ(read(list).list.sublist("Solver").sublist("Expert").sublist("PDAS").get<int>("Most"), 4);
}

TEST(ExpertParameters, faults_name_the_place_that_was_given) {
  Teuchos::ParameterList list;
  list.sublist("Solver").sublist("PDAS").set("Most", 0);
  EXPECT_TRUE(contains(message(list), "\"Solver/PDAS/Most\" = 0 is out of range")) << message(list);
  Teuchos::ParameterList other;
  other.sublist("Solver").set("PDAS", 3);
  EXPECT_TRUE(contains(message(other), "\"Solver/PDAS\" is a single value, expected a ParameterList"));
}

TEST(ExpertParameters, misspelt_names_are_offered_with_their_path) {
  Teuchos::ParameterList list;
  list.sublist("Solver").set("Inital guess", "zero");
  EXPECT_EQ(message(list),
            "deck.xml: unknown parameter \"Solver/Inital guess\"; did you mean \"Expert/Initial "
            "guess\"? Allowed here: \"Tolerance\", \"Expert\".");
  Teuchos::ParameterList other;
  other.sublist("Solver").sublist("PDSA");
  EXPECT_TRUE(contains(message(other), "unknown list \"Solver/PDSA\"; did you mean \"Expert/PDAS\"?"));
  EXPECT_TRUE(contains(refused("Solver/Inital guess", "zero"), "did you mean \"Expert/Initial guess\"?"));
  EXPECT_TRUE(contains(refused("Solver/PDSA/Most", "1"), "did you mean \"Expert/PDAS\"?"));
  EXPECT_TRUE(contains(refused("Solver/PDAS/Mots", "1"),
                       "unknown parameter \"Solver/PDAS/Mots\"; did you mean "
                       "\"Most\"?"));
}

// Whichever of the two places the deck and the assignment name: the assignment wins.
TEST(ExpertParameters, assignments_win_at_both_places) {
  const ParameterSpec spec = deck();
  for (const std::string given : {"Solver/PDAS/Most", "Solver/Expert/PDAS/Most"})
    for (const std::string assigned : {"Solver/PDAS/Most", "Solver/Expert/PDAS/Most"}) {
      Teuchos::ParameterList list;
      Teuchos::ParameterList& solver = list.sublist("Solver");
      (given == "Solver/PDAS/Most" ? solver : solver.sublist("Expert")).sublist("PDAS").set("Most", 3);
      std::vector<std::string> notes;
      spec.set(list, assigned, "4", "--set", &notes);
      EXPECT_EQ(notes.size(), assigned == "Solver/PDAS/Most" ? 1u : 0u) << assigned;
      EXPECT_EQ(read(list).list.sublist("Solver").sublist("Expert").sublist("PDAS").get<int>("Most"), 4);
    }
}

TEST(ExpertParameters, common_part_of_two_descriptions) {
  ParameterSpec solver("Solver", "Another solver.");
  solver.real("Tolerance", 1e-4, Range(), "Of it.");
  solver.expert().list(ParameterSpec("PDAS", "Some.").integer("Most", 1, 1, 1000, "Most of them."));
  ParameterSpec other("other", "Another deck.");
  other.list(solver);
  const Teuchos::ParameterList part = other.commonPart(deck().defaults());
  EXPECT_TRUE(Teuchos::haveSameValues(other.validated(part, "part"), part));
  EXPECT_EQ(part.sublist("Solver").sublist("Expert").sublist("PDAS").get<int>("Most"), 200);
  EXPECT_FALSE(part.isSublist("Bodies"));
  EXPECT_FALSE(part.sublist("Solver").sublist("Expert").isParameter("Initial guess"));
}

// A deck's old name gives way to an assignment of the present one, and the other way round.
TEST(ExpertParameters, parameters_with_a_new_name) {
  ParameterSpec spec("deck", "A deck.");
  spec.text("Local solver", "own", "Whose.").formerly("Implicit solver");
  const std::string note =
      "\"Implicit solver\" is now \"Local solver\"; this version still reads the old name";
  Teuchos::ParameterList old;
  old.set("Implicit solver", std::string("MUMPS"));
  std::vector<std::string> notes;
  Teuchos::ParameterList result = spec.validated(old, "deck.xml", &notes);
  EXPECT_EQ(result.get<std::string>("Local solver"), "MUMPS");
  EXPECT_FALSE(result.isParameter("Implicit solver"));
  EXPECT_EQ(notes, std::vector<std::string>{note});

  Teuchos::ParameterList both = old;
  both.set("Local solver", std::string("KLU2"));
  EXPECT_TRUE(contains(inputErrorOf([&] { spec.validated(both, "deck.xml"); }),
                       "\"Implicit solver\" and \"Local solver\", its present name, have different values"));
  both.set("Local solver", std::string("MUMPS"));
  EXPECT_EQ(spec.validated(both, "deck.xml").get<std::string>("Local solver"), "MUMPS");

  for (const char* path : {"Local solver", "Implicit solver"}) {
    Teuchos::ParameterList list = old;
    spec.set(list, path, "KLU2", "--set");
    EXPECT_EQ(spec.validated(list, "deck.xml").get<std::string>("Local solver"), "KLU2") << path;
  }
}

TEST(ExpertParameters, printed) {
  std::ostringstream overview, all, one, markdown;
  deck().writeOverview(overview);
  EXPECT_EQ(overview.str(), "A deck.\n"
                            "\n"
                            "Solver  -- The solver (+ 3 in Solver/Expert)\n"
                            "  Tolerance = 0.0001                Relative tolerance\n"
                            "\n"
                            "Bodies/<body>  -- A body (+ 1 in Bodies/<body>/Expert)\n"
                            "  Size\n");
  deck().writeText(all);
  EXPECT_TRUE(
      contains(all.str(), "\nSolver/Expert/PDAS  -- Active sets.\n  Most = 200   [integer in [1, 1000]]\n"));
  deck().writeText(one, "Bodies/wheel/Expert");
  EXPECT_TRUE(contains(one.str(), "Bodies/<body>/Expert  -- ")) << one.str();
  EXPECT_TRUE(contains(inputErrorOf([&] { deck().writeText(one, "Solver/Tolerence"); }),
                       "unknown list or parameter \"Solver/Tolerence\"; did you mean \"Tolerance\"?"));
  deck().writeMarkdown(markdown);
  EXPECT_TRUE(contains(markdown.str(), "## deck/Solver/Expert/PDAS\n"));
}

TEST(ExpertParameters, printed_xml_is_a_valid_deck_with_the_defaults) {
  std::ostringstream text;
  deck().writeXml(text);
  Teuchos::ParameterList list;
  Teuchos::updateParametersFromXmlString(text.str(), Teuchos::ptr(&list));
  EXPECT_TRUE(Teuchos::haveSameValues(read(list).list, deck().defaults()));
}

} // namespace test_expert_parameters
