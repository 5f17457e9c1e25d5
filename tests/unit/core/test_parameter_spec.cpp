// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_ParameterSpec.hpp"

#include "Harmos_TestErrors.hpp"
#include <Teuchos_XMLParameterListCoreHelpers.hpp>

#include <gtest/gtest.h>

#include <sstream>

namespace test_parameter_spec {

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

// Arrays, and a family: lists of the same kind by names of the user's choice.
ParameterSpec scene() {
  ParameterSpec body("<body>", "A body.");
  body.reals("Size", {1.0, 1.0, 1.0}, Range::above(0.0), "Its sides.");
  body.integers("Elements", {8, 4}, 1, 100, "Of each side.");
  body.texts("Materials", {}, "Their names.");
  body.list(ParameterSpec("Options", "Of the body.").boolean("Rigid", false, "Whether it bends."));
  ParameterSpec bodies("Bodies", "All bodies.");
  bodies.integer("Count", 0, 0, 9, "A parameter beside the family.");
  bodies.family(body);
  ParameterSpec spec("scene", "A scene.");
  spec.list(bodies);
  return spec;
}

std::string sceneMessage(const Teuchos::ParameterList& list) {
  return inputErrorOf([&] { scene().validated(list, "scene.xml"); });
}

template<class T>
Teuchos::Array<T> array(std::initializer_list<T> values) {
  return Teuchos::Array<T>(values);
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
  for (const char* part : {"## deck/Solver\n\nThe solver.\n\n",
                           "\n* `Tolerance`: real in (0, 1), default `0.0001`. Relative tolerance.\n",
                           "\n* `Method`: choice, default `\"Auto\"`. The method.\n"
                           "  * `Auto`: automatic\n"
                           "  * `SMALBE`: augmented Lagrangians\n",
                           "## deck/Model"})
    EXPECT_TRUE(contains(text.str(), part)) << part << "\n" << text.str();
}

TEST(ParameterSpec, markdown_is_wrapped_and_no_line_begins_with_a_mark) {
  const std::string words(118 - 36, 'a'); // after the head they fill a line
  ParameterSpec spec("deck", "A deck.");
  spec.choice("Law", "power", {{"power", std::string(118 - 14, 'b') + " - 1. The next line."}},
              words + " The next line.");
  std::ostringstream text;
  spec.writeMarkdown(text);
  EXPECT_EQ(text.str(), "# Parameters of deck\n\nA deck.\n\n* `Law`: choice, default `\"power\"`. " + words +
                            "\n  The next line.\n  * `power`:\n    " + std::string(118 - 14, 'b') +
                            " - 1. The\n    next line.\n\n");
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

TEST(ParameterSpec, members_of_families_are_completed_by_defaults) {
  Teuchos::ParameterList list;
  list.sublist("Bodies").sublist("wheel").set("Size", array({2.0, 3.0, 4.0}));
  list.sublist("Bodies").sublist("axle").set("Materials", array<std::string>({"steel", "brass"}));
  const Teuchos::ParameterList result = scene().validated(list, "scene.xml").sublist("Bodies");
  EXPECT_EQ(result.name(result.begin()), "Count");
  EXPECT_EQ(result.numParams(), 3); // no member but those that were given
  EXPECT_EQ(result.sublist("wheel").get<Teuchos::Array<double>>("Size"), array({2.0, 3.0, 4.0}));
  EXPECT_EQ(result.sublist("wheel").get<Teuchos::Array<int>>("Elements"), array({8, 4}));
  EXPECT_EQ(result.sublist("wheel").get<Teuchos::Array<std::string>>("Materials").size(), 0);
  EXPECT_FALSE(result.sublist("wheel").sublist("Options").get<bool>("Rigid"));
  EXPECT_EQ(result.sublist("axle").get<Teuchos::Array<double>>("Size"), array({1.0, 1.0, 1.0}));
  EXPECT_EQ(result.sublist("axle").get<Teuchos::Array<std::string>>("Materials"),
            array<std::string>({"steel", "brass"}));
}

TEST(ParameterSpec, faults_in_members_of_families_have_their_path) {
  Teuchos::ParameterList list;
  list.sublist("Bodies").sublist("wheel").set("Sise", array({2.0, 3.0, 4.0}));
  EXPECT_EQ(
      sceneMessage(list),
      "scene.xml: unknown parameter \"Bodies/wheel/Sise\"; did you mean \"Size\"? Allowed here: \"Size\", "
      "\"Elements\", \"Materials\", \"Options\".");
  Teuchos::ParameterList nested;
  nested.sublist("Bodies").sublist("wheel").sublist("Options").set("Rigidd", true);
  EXPECT_TRUE(contains(sceneMessage(nested), "unknown parameter \"Bodies/wheel/Options/Rigidd\""));
  Teuchos::ParameterList value;
  value.sublist("Bodies").set("wheel", 3);
  EXPECT_TRUE(contains(sceneMessage(value), "unknown parameter \"Bodies/wheel\""));
}

TEST(ParameterSpec, arrays_of_wrong_length) {
  Teuchos::ParameterList list;
  list.sublist("Bodies").sublist("wheel").set("Size", array({0.1, 2.0}));
  EXPECT_EQ(sceneMessage(list),
            "scene.xml: \"Bodies/wheel/Size\" is an array ({0.1, 2}), expected 3 real numbers "
            "(type=\"Array(double)\") in (0, inf)");
  Teuchos::ParameterList empty;
  empty.sublist("Bodies").sublist("wheel").set("Elements", Teuchos::Array<int>());
  EXPECT_EQ(sceneMessage(empty), "scene.xml: \"Bodies/wheel/Elements\" is an array ({}), expected 2 integers "
                                 "(type=\"Array(int)\") in [1, 100]");
}

TEST(ParameterSpec, arrays_of_wrong_type) {
  const auto messageWith = [](const std::string& name, auto value) {
    Teuchos::ParameterList list;
    list.sublist("Bodies").sublist("wheel").set(name, value);
    return sceneMessage(list);
  };
  EXPECT_TRUE(
      contains(messageWith("Elements", array({1.0, 2.0})), "is an array ({1, 2}), expected 2 integers"));
  EXPECT_TRUE(contains(messageWith("Size", 2.5), "is a real number (2.5), expected 3 real numbers"));
  EXPECT_TRUE(contains(messageWith("Size", array<std::string>({"a", "b", "c"})), "expected 3 real numbers"));
  EXPECT_TRUE(contains(messageWith("Materials", std::string("steel")),
                       "is a string (\"steel\"), expected strings (type=\"Array(string)\")"));
  // Whole numbers are real numbers, in arrays as well.
  Teuchos::ParameterList list;
  list.sublist("Bodies").sublist("wheel").set("Size", array({1, 2, 3}));
  EXPECT_EQ(
      scene().validated(list, "").sublist("Bodies").sublist("wheel").get<Teuchos::Array<double>>("Size"),
      array({1.0, 2.0, 3.0}));
}

TEST(ParameterSpec, every_entry_of_an_array_is_in_range) {
  Teuchos::ParameterList list;
  list.sublist("Bodies").sublist("wheel").set("Size", array({1.0, 2.0, 0.0}));
  EXPECT_TRUE(contains(sceneMessage(list), "\"Bodies/wheel/Size\" = 0 is out of range"));
  list.sublist("Bodies").sublist("wheel").set("Size",
                                              array({1.0, std::numeric_limits<double>::quiet_NaN(), 1.0}));
  EXPECT_TRUE(contains(sceneMessage(list), "is out of range"));
  list.sublist("Bodies").sublist("wheel").set("Size", array({1.0, 2.0, 3.0}));
  list.sublist("Bodies").sublist("wheel").set("Elements", array({1, 101}));
  EXPECT_TRUE(contains(sceneMessage(list), "\"Bodies/wheel/Elements\" = 101 is out of range"));
}

TEST(ParameterSpec, assignment_of_arrays_and_to_members_of_families) {
  const ParameterSpec spec = scene();
  Teuchos::ParameterList list;
  spec.set(list, "Bodies/wheel/Size", "{1, 2.5, 3e-1}", "--set");
  spec.set(list, "Bodies/wheel/Elements", " 3,4 ", "--set"); // braces may be left out
  spec.set(list, "Bodies/wheel/Materials", "{red brass, steel}", "--set");
  spec.set(list, "Bodies/wheel/Options/Rigid", "true", "--set");
  const Teuchos::ParameterList wheel = spec.validated(list, "").sublist("Bodies").sublist("wheel");
  EXPECT_EQ(wheel.get<Teuchos::Array<double>>("Size"), array({1.0, 2.5, 0.3}));
  EXPECT_EQ(wheel.get<Teuchos::Array<int>>("Elements"), array({3, 4}));
  EXPECT_EQ(wheel.get<Teuchos::Array<std::string>>("Materials"), array<std::string>({"red brass", "steel"}));
  EXPECT_TRUE(wheel.sublist("Options").get<bool>("Rigid"));
  EXPECT_EQ(inputErrorOf([&] { spec.set(list, "Bodies/wheel/Elements", "{3, 4.5}", "--set"); }),
            "--set: \"{3, 4.5}\" is not a valid value of \"Bodies/wheel/Elements\", expected 2 integers "
            "(type=\"Array(int)\") in [1, 100]");
  EXPECT_THROW(spec.set(list, "Bodies/wheel/Size", "{1, two, 3}", "--set"), InputError);
  EXPECT_TRUE(contains(inputErrorOf([&] { spec.set(list, "Bodies/wheel/Sise", "1", "--set"); }),
                       "unknown parameter \"Bodies/wheel/Sise\"; did you mean \"Size\"?"));
}

TEST(ParameterSpec, families_in_the_reference) {
  std::ostringstream markdown, text, xml;
  scene().writeMarkdown(markdown);
  // The sign would begin an HTML element, and the name would not be shown.
  for (const char* part :
       {"## scene/Bodies/\\<body>\n\nA body.\n",
        "* `Size`: reals in (0, inf), default `{1, 1, 1}`. Its sides.\n",
        "* `Elements`: integers in [1, 100], default `{8, 4}`. Of each side.\n",
        "* `Materials`: strings, default `{}`. Their names.\n",
        "* `Rigid`: boolean, default `false`. Whether it bends.\n", "## scene/Bodies/\\<body>/Options\n"})
    EXPECT_TRUE(contains(markdown.str(), part)) << part << "\n" << markdown.str();
  scene().writeText(text);
  for (const char* part : {"Bodies/<body>  -- A body.", "  Size = {1, 1, 1}   [reals in (0, inf)]",
                           "  Materials = {}   [strings]", "Bodies/<body>/Options  -- Of the body."})
    EXPECT_TRUE(contains(text.str(), part)) << part << "\n" << text.str();
  // A deck with the defaults: it has no member.
  scene().writeXml(xml);
  EXPECT_FALSE(contains(xml.str(), "body"));
  Teuchos::ParameterList list;
  Teuchos::updateParametersFromXmlString(xml.str(), Teuchos::ptr(&list));
  EXPECT_TRUE(Teuchos::haveSameValues(scene().validated(list, "printed"), scene().defaults()));
}

// Decks pass through XML on their way to the other ranks.
TEST(ParameterSpec, validated_arrays_survive_xml) {
  Teuchos::ParameterList list;
  list.sublist("Bodies").sublist("wheel").set("Size", array({0.1, 1.0 / 3.0, 1e-300}));
  const Teuchos::ParameterList before = scene().validated(list, "");
  std::ostringstream text;
  Teuchos::writeParameterListToXmlOStream(before, text);
  Teuchos::ParameterList after;
  Teuchos::updateParametersFromXmlString(text.str(), Teuchos::ptr(&after));
  EXPECT_EQ(after.sublist("Bodies").sublist("wheel").get<Teuchos::Array<double>>("Size"),
            before.sublist("Bodies").sublist("wheel").get<Teuchos::Array<double>>("Size"));
  EXPECT_EQ(after.sublist("Bodies").sublist("wheel").get<Teuchos::Array<std::string>>("Materials").size(), 0);
}

TEST(ParameterSpec, a_series_has_any_length_and_survives_xml) {
  ParameterSpec spec("deck", "A deck.");
  spec.series("Times", Range::above(0.0), "Of steps.");
  EXPECT_EQ(spec.defaults().get<Teuchos::Array<double>>("Times").size(), 0);
  for (const Teuchos::Array<double>& times : {array<double>({}), array({1.0, 2.5, 4.0})}) {
    Teuchos::ParameterList list;
    list.set("Times", times);
    std::ostringstream text;
    Teuchos::writeParameterListToXmlOStream(spec.validated(list, "test"), text);
    const Teuchos::ParameterList again = *Teuchos::getParametersFromXmlString(text.str());
    EXPECT_EQ(spec.validated(again, "test").get<Teuchos::Array<double>>("Times"), times);
  }
  Teuchos::ParameterList list;
  list.set("Times", array({1.0, -2.0}));
  EXPECT_NE(inputErrorOf([&] { spec.validated(list, "test"); }).find("-2 is out of range"),
            std::string::npos);
}

TEST(ParameterSpec, an_absent_name_is_told_why) {
  ParameterSpec spec("deck", "A deck.");
  spec.real("Gap", 0.0, Range(), "A gap.").absent("History", "a gap does not change");
  Teuchos::ParameterList list;
  list.set("History", std::string("ramp"));
  const std::string fault = inputErrorOf([&] { spec.validated(list, "test"); });
  EXPECT_NE(fault.find("unknown parameter \"History\": a gap does not change"), std::string::npos) << fault;
  Teuchos::ParameterList other = spec.defaults();
  const std::string second = inputErrorOf([&] { spec.set(other, "History", "ramp", "command line"); });
  EXPECT_NE(second.find("a gap does not change"), std::string::npos) << second;
}

namespace {

ParameterSpec grouped() {
  ParameterSpec spec("deck", "A deck.");
  spec.choiceOrInteger("Groups", "auto", {{"auto", "by a model"}, {"rank", "one a rank"}}, 1, 100, "Sizes.");
  return spec;
}

std::string groups(const Teuchos::ParameterList& list) {
  return grouped().validated(list, "deck.xml").get<std::string>("Groups");
}

template<class T>
Teuchos::ParameterList groupsList(const T& value) {
  Teuchos::ParameterList list;
  list.set("Groups", value);
  return list;
}

} // namespace

// A name or a number; of type int in a deck, or as text, as it is assigned on a command line. The validated
// list has text.
TEST(ParameterSpec, choices_may_have_integers_beside_them) {
  EXPECT_EQ(groups({}), "auto");
  EXPECT_EQ(groups(groupsList(std::string("rank"))), "rank");
  EXPECT_EQ(groups(groupsList(7)), "7");
  EXPECT_EQ(groups(groupsList(std::string("7"))), "7");
  EXPECT_EQ(groups(groupsList(std::string(" 100 "))), "100");
  Teuchos::ParameterList assigned;
  grouped().set(assigned, "Groups", "12", "--set");
  EXPECT_EQ(groups(assigned), "12");
  grouped().set(assigned, "Groups", "rank", "--set");
  EXPECT_EQ(groups(assigned), "rank");
  // What is validated is valid.
  EXPECT_EQ(groups(grouped().validated(groupsList(7), "deck.xml")), "7");
}

TEST(ParameterSpec, choices_with_integers_refuse_the_rest) {
  const auto fault = [](const Teuchos::ParameterList& list) { return inputErrorOf([&] { groups(list); }); };
  for (const std::string& text : {fault(groupsList(0)), fault(groupsList(std::string("0")))})
    EXPECT_TRUE(contains(text, "\"Groups\" = 0 is out of range")) << text;
  EXPECT_TRUE(contains(fault(groupsList(101)), "out of range"));
  EXPECT_TRUE(contains(fault(groupsList(-3)), "out of range"));
  EXPECT_EQ(fault(groupsList(std::string("ranks"))),
            "deck.xml: \"Groups\" = \"ranks\" is not allowed, expected one of \"auto\", \"rank\" "
            "(type=\"string\"), or an integer (type=\"int\") in [1, 100]; did you mean \"rank\"?");
  for (const char* word : {"4.5", "4 5", "4x", "", "99999999999"})
    EXPECT_TRUE(contains(fault(groupsList(std::string(word))), "is not allowed")) << word;
  EXPECT_TRUE(contains(fault(groupsList(2.0)), "is a real number (2), expected one of"))
      << fault(groupsList(2.0));
  EXPECT_TRUE(contains(fault(groupsList(true)), "is a boolean (true), expected one of"))
      << fault(groupsList(true));
}

TEST(ParameterSpec, choices_with_integers_in_the_reference) {
  std::ostringstream markdown, text, xml;
  grouped()
      .list(ParameterSpec("Inner", "A list.")
                .choiceOrInteger("Groups", "3", {{"auto", "by a model"}}, 1, 9, "More sizes."))
      .writeMarkdown(markdown);
  for (const char* part :
       {"* `Groups`: choice or integer in [1, 100], default `\"auto\"`. Sizes.\n"
        "  * `auto`: by a model\n"
        "  * `rank`: one a rank\n",
        "* `Groups`: choice or integer in [1, 9], default `\"3\"`. More sizes.\n  * `auto`: by a model\n"})
    EXPECT_TRUE(contains(markdown.str(), part)) << part << "\n" << markdown.str();
  ParameterSpec outer("outer", "An outer deck.");
  outer.list(grouped());
  outer.writeText(text);
  EXPECT_TRUE(contains(text.str(), "  Groups = \"auto\"   [choice or integer in [1, 100]]")) << text.str();
  // A printed deck is a valid one, with an integer too.
  grouped().writeXml(xml);
  Teuchos::ParameterList list;
  Teuchos::updateParametersFromXmlString(xml.str(), Teuchos::ptr(&list));
  EXPECT_EQ(groups(list), "auto");
  EXPECT_EQ(groups(*Teuchos::getParametersFromXmlString(
                "<ParameterList><Parameter name=\"Groups\" type=\"int\" value=\"8\"/></ParameterList>")),
            "8");
}

// Teuchos' own validation, which library users may call, knows one type of a parameter: numbers are text
// there.
TEST(ParameterSpec, teuchos_validators_let_integers_beside_choices_pass_as_text) {
  const auto valid = grouped().teuchosList();
  EXPECT_NO_THROW(groupsList(std::string("rank")).validateParameters(*valid));
  EXPECT_NO_THROW(groupsList(std::string("7")).validateParameters(*valid));
}

} // namespace test_parameter_spec
