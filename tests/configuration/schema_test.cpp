// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/data/configuration/json_schema.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <tests/configuration/experiment.hpp>

namespace tactus::configuration {
namespace {

using nlohmann::json;
using testing::Experiment;

json schema() { return json::parse(json_schema<Experiment>("Experiment")); }

bool loader_admits(const std::string& path, const std::string& value) {
  const Result<Document> document = Document::parse(path + " = " + value, "t.toml");
  EXPECT_TRUE(document) << path << " = " << value;
  return document->read<Experiment>().ok();
}

/// What the keywords of JSON Schema say about a number.
bool schema_admits(const json& keywords, double value) {
  return std::isfinite(value) && (!keywords.contains("minimum") || value >= keywords["minimum"].get<double>()) &&
         (!keywords.contains("exclusiveMinimum") || value > keywords["exclusiveMinimum"].get<double>()) &&
         (!keywords.contains("maximum") || value <= keywords["maximum"].get<double>());
}

std::string as_toml(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%.17e", value);
  return buffer;
}

void for_each_leaf(const json& section, const std::string& path,
                   const std::function<void(const std::string&, const json&)>& visit) {
  for (const auto& [key, property] : section["properties"].items()) {
    const std::string below = path.empty() ? key : path + "." + key;
    if (property["type"] == "object") {
      for_each_leaf(property, below, visit);
    } else {
      visit(below, property);
    }
  }
}

TEST(Schema, ItIsDraft2020WithNestedClosedObjects) {
  const json root = schema();
  EXPECT_EQ(root["$schema"], "https://json-schema.org/draft/2020-12/schema");
  EXPECT_EQ(root["title"], "Experiment");
  EXPECT_EQ(root["type"], "object");
  EXPECT_EQ(root["additionalProperties"], false);
  const json& filter = root["properties"]["slave"]["properties"]["velocity_filter"];
  EXPECT_EQ(filter["type"], "object");
  EXPECT_EQ(filter["additionalProperties"], false);
  EXPECT_EQ(filter["description"], "Filters the measured velocity.");
  EXPECT_EQ(filter["properties"].size(), 2U);
}

TEST(Schema, EachKeyHasItsTypeBoundsDefaultAndMeaning) {
  const json root = schema()["properties"];
  EXPECT_EQ(root["slave"]["properties"]["mass_kg"], json::parse(R"({
    "type": "number", "exclusiveMinimum": 0, "default": 0.5, "description": "Moving mass. [kg]"})"));
  EXPECT_EQ(root["slave"]["properties"]["offset_m"], json::parse(R"({
    "type": "number", "default": 0, "description": "Where it rests | at the start. [m]"})"));
  EXPECT_EQ(root["control"]["properties"]["force_gain"], json::parse(R"({
    "type": "number", "minimum": 0, "maximum": 10, "default": 1, "description": "Force scale."})"));
  EXPECT_EQ(root["control"]["properties"]["taps"], json::parse(R"({
    "type": "integer", "minimum": 1, "maximum": 4096, "default": 32, "description": "Number of taps."})"));
  EXPECT_TRUE(root["control"]["properties"]["taps"]["maximum"].is_number_integer());
  EXPECT_EQ(root["control"]["properties"]["cancellation"], json::parse(R"({
    "type": "string", "enum": ["off", "model", "adaptive"], "default": "model",
    "description": "How the induced motion is cancelled."})"));
  EXPECT_EQ(root["slave"]["properties"]["velocity_filter"]["properties"]["enabled"], json::parse(R"({
    "type": "boolean", "default": true, "description": "Whether it filters at all."})"));
  EXPECT_EQ(root["task"]["properties"]["kind"], json::parse(R"({
    "type": "string", "default": "tapping", "description": "What is done."})"));
}

TEST(Schema, TheLoaderAdmitsTheNumbersThatTheSchemaAdmits) {
  int admitted = 0;
  int refused = 0;
  for_each_leaf(schema(), "", [&](const std::string& path, const json& keywords) {
    const double infinity = std::numeric_limits<double>::infinity();
    std::vector<double> values{0.0, -1.0, 1.0, 1e300, -1e300, infinity, -infinity, std::nan("")};
    for (const char* bound : {"minimum", "exclusiveMinimum", "maximum"}) {
      if (!keywords.contains(bound)) continue;
      const auto edge = keywords[bound].get<double>();
      for (const double value :
           {edge, std::nextafter(edge, infinity), std::nextafter(edge, -infinity), edge + 1, edge - 1}) {
        values.push_back(value);
      }
    }
    for (const double value : values) {
      bool expected = schema_admits(keywords, value);
      bool found = false;
      if (keywords["type"] == "number") {
        found = loader_admits(path, as_toml(value));
      } else if (keywords["type"] == "integer" && std::trunc(value) == value && std::abs(value) < 1e15) {
        found = loader_admits(path, std::to_string(static_cast<std::int64_t>(value)));
      } else {
        expected = false;
        found = loader_admits(path, as_toml(value));
      }
      EXPECT_EQ(found, expected) << path << " = " << as_toml(value);
      ++(found ? admitted : refused);
    }
  });
  EXPECT_GT(admitted, 20);
  EXPECT_GT(refused, 20);
}

TEST(Schema, TheBoundsAreThoseOfTheDescription) {
  // Written by hand: path, value, whether it lies within the bounds.
  const std::vector<std::tuple<std::string, std::string, bool>> cases{
      {"slave.mass_kg", "0.0", false},
      {"slave.mass_kg", "5e-324", true},
      {"slave.mass_kg", "1e308", true},
      {"slave.stiffness_N_per_m", "0.0", true},
      {"slave.stiffness_N_per_m", "-0.0", true},
      {"slave.stiffness_N_per_m", "-5e-324", false},
      {"control.force_gain", "10", true},
      {"control.force_gain", "10.000000000000002", false},
      {"control.taps", "0", false},
      {"control.taps", "1", true},
      {"control.taps", "4096", true},
      {"control.taps", "4097", false},
      {"duration_s", "3600.0", true},
      {"duration_s", "3600.0000000000005", false}};
  const json root = schema();
  for (const auto& [path, value, admitted] : cases) {
    EXPECT_EQ(loader_admits(path, value), admitted) << path << " = " << value;
    for_each_leaf(root, "", [&, &wanted = path, &text = value, &expected = admitted](const auto& leaf, const json& k) {
      if (leaf == wanted) {
        EXPECT_EQ(schema_admits(k, std::strtod(text.c_str(), nullptr)), expected) << leaf << " = " << text;
      }
    });
  }
}

TEST(Schema, TheLoaderAdmitsTheDefaultsAndTheWordsOfTheSchema) {
  int words = 0;
  for_each_leaf(schema(), "", [&](const std::string& path, const json& keywords) {
    EXPECT_TRUE(loader_admits(path, keywords["default"].dump())) << path;
    if (!keywords.contains("enum")) return;
    for (const auto& word : keywords["enum"]) {
      EXPECT_TRUE(loader_admits(path, word.dump()));
      ++words;
    }
  });
  EXPECT_EQ(words, 3);
}

}  // namespace
}  // namespace tactus::configuration
