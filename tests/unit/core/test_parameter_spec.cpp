// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_ParameterSpec.hpp"

#include "Harmos_TestErrors.hpp"
#include <Teuchos_XMLParameterListCoreHelpers.hpp>

#include <gtest/gtest.h>

#include <sstream>

using namespace Harmos;

namespace {

ParameterSpec deck() {
  ParameterSpec solver("Solver", "The solver.");
  solver.real("Tolerance", 1e-4, Range::strictlyWithin(0.0, 1.0), "Relative tolerance.");
  solver.choice("Method", "Auto", {{"Auto", "automatic"}, {"SMALBE", "augmented Lagrangians"}},
                "The method.");
  ParameterSpec model("Model", "The model.");
  model.integer("Subdomains per side", 4, 1, 1024, "1/H.");
  model.boolean("Tied", false, "Ties the bodies.");
  model.text("Label", "none", "A label.");
  ParameterSpec spec("deck", "A deck.");
  spec.list(model).list(solver);
  return spec;
}

std::string message(const Teuchos::ParameterList& list) {
  return inputErrorOf([&] { deck().validated(list, "deck.xml"); });
}

} // namespace

TEST(ParameterSpec, completes_by_defaults) {
  Teuchos::ParameterList list;
  list.sublist("Model").set("Subdomains per side", 8);
  const Teuchos::ParameterList result = deck().validated(list, "deck.xml");
  EXPECT_EQ(result.sublist("Model").get<int>("Subdomains per side"), 8);
  EXPECT_EQ(result.sublist("Model").get<bool>("Tied"), false);
  EXPECT_EQ(result.sublist("Solver").get<double>("Tolerance"), 1e-4);
  EXPECT_EQ(result.sublist("Solver").get<std::string>("Method"), "Auto");
}

TEST(ParameterSpec, unknown_name_gets_the_nearest_one_and_its_path) {
  Teuchos::ParameterList list;
  list.sublist("Solver").set("Tolerence", 1e-3);
  EXPECT_EQ(message(list),
            "deck.xml: unknown parameter \"Solver/Tolerence\"; did you mean \"Tolerance\"? Allowed "
            "here: \"Tolerance\", \"Method\".");
}

TEST(ParameterSpec, unknown_list) {
  Teuchos::ParameterList list;
  list.sublist("Modle").set("Subdomains per side", 1);
  EXPECT_TRUE(contains(message(list), "unknown list \"Modle\"; did you mean \"Model\"?"));
}

TEST(ParameterSpec, nothing_near_is_offered_for_a_far_name) {
  EXPECT_EQ(nearestName("Temperature", {"Method", "Label"}), "");
  EXPECT_EQ(nearestName("method", {"Method", "Label"}), "Method");
}

TEST(ParameterSpec, wrong_type) {
  Teuchos::ParameterList list;
  list.sublist("Model").set("Subdomains per side", 2.5);
  EXPECT_EQ(message(list),
            "deck.xml: \"Model/Subdomains per side\" is a real number (2.5), expected an integer "
            "(type=\"int\") in [1, 1024]");
}

TEST(ParameterSpec, whole_numbers_are_real_numbers) {
  ParameterSpec spec("s", "");
  spec.real("x", 0.0, Range(), "");
  Teuchos::ParameterList list;
  list.set("x", 3);
  EXPECT_EQ(spec.validated(list, "").get<double>("x"), 3.0);
}

TEST(ParameterSpec, out_of_range_and_not_a_number) {
  Teuchos::ParameterList list;
  list.sublist("Solver").set("Tolerance", 1.0);
  EXPECT_TRUE(contains(message(list), "\"Solver/Tolerance\" = 1 is out of range"));
  list.sublist("Solver").set("Tolerance", std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(contains(message(list), "is out of range"));
  list.sublist("Solver").set("Tolerance", 0.999);
  EXPECT_EQ(message(list), "");
}

TEST(ParameterSpec, choice_offers_values) {
  Teuchos::ParameterList list;
  list.sublist("Solver").set("Method", std::string("smalbe"));
  EXPECT_EQ(message(list),
            "deck.xml: \"Solver/Method\" = \"smalbe\" is not allowed, expected one of \"Auto\", "
            "\"SMALBE\" (type=\"string\"); did you mean \"SMALBE\"?");
}

TEST(ParameterSpec, all_faults_are_told_at_once) {
  Teuchos::ParameterList list;
  list.sublist("Solver").set("Tolerance", -1.0);
  list.sublist("Model").set("Tied", 1);
  list.set("Extra", 1);
  const std::string text = message(list);
  EXPECT_TRUE(contains(text, "3 faults:"));
  EXPECT_TRUE(contains(text, "Solver/Tolerance"));
  EXPECT_TRUE(contains(text, "\"Model/Tied\" is an integer (1), expected a boolean"));
  EXPECT_TRUE(contains(text, "\"Extra\""));
}

TEST(ParameterSpec, list_in_the_place_of_a_value_and_the_reverse) {
  Teuchos::ParameterList list;
  list.sublist("Model").sublist("Tied");
  EXPECT_TRUE(contains(message(list), "\"Model/Tied\" is a list, expected a boolean"));
  Teuchos::ParameterList other;
  other.set("Model", 3);
  EXPECT_TRUE(contains(message(other), "\"Model\" is a single value, expected a ParameterList"));
}

TEST(ParameterSpec, assignment_takes_the_type_from_the_specification) {
  Teuchos::ParameterList list;
  const ParameterSpec spec = deck();
  spec.set(list, "Model/Subdomains per side", "16", "--set");
  spec.set(list, "Model/Tied", "true", "--set");
  spec.set(list, "Solver/Tolerance", "1e-6", "--set");
  spec.set(list, "Model/Label", "a = b", "--set");
  EXPECT_EQ(list.sublist("Model").get<int>("Subdomains per side"), 16);
  EXPECT_EQ(list.sublist("Model").get<bool>("Tied"), true);
  EXPECT_EQ(list.sublist("Solver").get<double>("Tolerance"), 1e-6);
  EXPECT_EQ(list.sublist("Model").get<std::string>("Label"), "a = b");
  EXPECT_THROW(spec.set(list, "Model/Subdomains per side", "16x", "--set"), InputError);
  EXPECT_THROW(spec.set(list, "Model/Tied", "yes", "--set"), InputError);
  EXPECT_THROW(spec.set(list, "Model/Nothing", "1", "--set"), InputError);
  EXPECT_THROW(spec.set(list, "Nothing/Tied", "true", "--set"), InputError);
}

TEST(ParameterSpec, printed_xml_is_a_valid_deck_with_the_defaults) {
  std::ostringstream text;
  deck().writeXml(text);
  Teuchos::ParameterList list;
  Teuchos::updateParametersFromXmlString(text.str(), Teuchos::ptr(&list));
  EXPECT_TRUE(Teuchos::haveSameValues(deck().validated(list, "printed"), deck().defaults()));
}

TEST(ParameterSpec, markdown_names_everything) {
  std::ostringstream text;
  deck().writeMarkdown(text);
  for (const char* part :
       {"## deck/Solver", "| `Tolerance` | real | `0.0001` | (0, 1) | Relative tolerance. |",
        "`SMALBE`: augmented Lagrangians", "## deck/Model"})
    EXPECT_TRUE(contains(text.str(), part)) << part;
}

TEST(ParameterSpec, teuchos_validators_refuse_what_the_specification_refuses) {
  const auto valid = deck().teuchosList();
  Teuchos::ParameterList list;
  list.sublist("Solver").set("Tolerance", 1.0);
  EXPECT_ANY_THROW(list.validateParameters(*valid));
  list.sublist("Solver").set("Tolerance", 0.5);
  EXPECT_NO_THROW(list.validateParameters(*valid));
  list.sublist("Solver").set("Method", std::string("None"));
  EXPECT_ANY_THROW(list.validateParameters(*valid));
}
