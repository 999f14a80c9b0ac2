// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/experiment_of.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tactus::experiments {
namespace experiment_of_test {

using Json = nlohmann::ordered_json;

enum class FallKind { fall };
constexpr auto enumerators(FallKind) { return std::array{Enumerator{FallKind::fall, "fall"}}; }

struct FallTask {
  FallKind kind = FallKind::fall;
  double height_m = 5.0;
  double gravity_m_per_s2 = 10.0;
  static constexpr auto fields() {
    return List{field("kind", &FallTask::kind, "Which experiment this is."),
                field("height_m", &FallTask::height_m, units::metre, positive_up_to(100.0), "Of the fall."),
                field("gravity_m_per_s2", &FallTask::gravity_m_per_s2, units::none, positive, "Where it falls.")};
  }
};

/// What a program of a user's own would bring: a fall from a height, with a section that `tapping` has too.
struct FallParams {
  simulation::ServoParams servo;
  FallTask task;
  static constexpr auto fields() {
    return List{field("servo", &FallParams::servo, "The servo clock."), field("task", &FallParams::task, "The fall.")};
  }
};

class Fall final : public SweepOf<FallParams, double> {
  Check check(const FallParams& params) const override {
    if (params.task.height_m != 13.0) return std::nullopt;
    return Error{.code = ErrorCode::inconsistent, .parameter = "task.height_m", .message = "is unlucky", .place = {}};
  }
  Result<double> run_one(const FallParams& params) const override {
    if (params.task.height_m > 50.0) {
      return Error{.code = ErrorCode::failed, .parameter = "task.height_m", .message = "was too much", .place = {}};
    }
    return std::sqrt(2.0 * params.task.height_m / params.task.gravity_m_per_s2);
  }
  Presentation present(const Request& request, const Runs& runs) const override {
    report::Table table = table_of_runs(runs.front().settings, {{"duration", "s"}}, "Falls");
    for (const Run& run : runs) add_row(table, run.settings, {report::number(run.found, 3)});
    std::string json = runs_json(request, runs, [](const Run& run) {
      return metrics_json({{"height_m", run.params.task.height_m}, {"duration_s", run.found}});
    });
    return {.text = table.to_text(), .json = std::move(json), .page = report::Page(request.name), .figures = {}};
  }
};

/// As the command line would ask for it, after the program registered its kind.
Result<Outcome> outcome_of(const std::string& toml, const std::vector<std::string>& variations = {},
                           std::vector<double>* progress = nullptr) {
  register_experiment(std::make_unique<Fall>());
  Request request{.document = configuration::Document::parse(toml, "fall.toml").value(),
                  .variations = {},
                  .name = "fall",
                  .command = "my-tactus run fall.toml"};
  for (const std::string& text : variations) request.variations.push_back(parse_variation(text).value());
  const auto experiment = choose_experiment(request.document);
  if (!experiment) return experiment.error();
  return experiment.value()->run(request, [progress](double done) {
    if (progress != nullptr) progress->push_back(done);
  });
}

const std::string file = "[task]\nkind = 'fall'\nheight_m = 20.0\n";

TEST(SweepOf, RunsEachCombinationOfAKindThatAProgramRegistered) {
  std::vector<double> progress;
  const auto outcome = outcome_of(file, {"task.height_m=5,20", "task.gravity_m_per_s2=10,2.5"}, &progress);
  ASSERT_TRUE(outcome) << describe(outcome.error());
  const Json expected = Json::parse(R"({"experiment": "fall", "runs": [
    {"set": {"task.height_m": 5, "task.gravity_m_per_s2": 10}, "metrics": {"height_m": 5.0, "duration_s": 1.0}},
    {"set": {"task.height_m": 5, "task.gravity_m_per_s2": 2.5}, "metrics": {"height_m": 5.0, "duration_s": 2.0}},
    {"set": {"task.height_m": 20, "task.gravity_m_per_s2": 10}, "metrics": {"height_m": 20.0, "duration_s": 2.0}},
    {"set": {"task.height_m": 20, "task.gravity_m_per_s2": 2.5}, "metrics": {"height_m": 20.0, "duration_s": 4.0}}]})");
  EXPECT_EQ(outcome->json, expected.dump(2) + "\n");
  EXPECT_EQ(progress, (std::vector{0.25, 0.5, 0.75, 1.0}));
}

TEST(SweepOf, EndsThePageWithWhatRepeatsTheRun) {
  const auto outcome = outcome_of(file);
  ASSERT_TRUE(outcome);
  EXPECT_NE(outcome->html.find("my-tactus run fall.toml"), std::string::npos);
  EXPECT_NE(outcome->html.find("height_m = 20.0"), std::string::npos);
  EXPECT_NE(outcome->configuration.find("gravity_m_per_s2 = 10.0"), std::string::npos) << "defaults included";
}

TEST(SweepOf, ChecksEveryCombinationBeforeTheFirstIsRun) {
  std::vector<double> progress;
  const auto refused = outcome_of(file, {"task.height_m=5,13"}, &progress);
  ASSERT_FALSE(refused);
  EXPECT_EQ(describe(refused.error()), "--vary task.height_m=13: task.height_m: is unlucky");
  EXPECT_TRUE(progress.empty());
}

TEST(SweepOf, SaysWhereAValueWasWrittenThatARunFailedOn) {
  EXPECT_EQ(describe(outcome_of(file, {"task.height_m=5,60"}).error()),
            "--vary task.height_m=60: task.height_m: was too much");
  EXPECT_EQ(describe(outcome_of("[task]\nkind = 'fall'\nheight_m = 60.0\n").error()),
            "fall.toml:3:12: task.height_m: was too much");
  EXPECT_EQ(describe(outcome_of("[task]\nkind = 'fall'\nheigth_m = 6.0\n").error()),
            "fall.toml:3:1: task.heigth_m: unknown key: did you mean height_m?");
}

TEST(ExperimentOf, TheWordOfTheFileNamesTheKindItsSchemaAndItsPage) {
  const Fall fall;
  EXPECT_EQ(fall.kind(), "fall");
  const Json schema = Json::parse(fall.schema());
  EXPECT_EQ(schema["title"], "tactus experiment: fall");
  EXPECT_TRUE(schema["properties"]["task"]["properties"].contains("height_m"));
  EXPECT_NE(fall.reference().find("# Experiment `fall`"), std::string::npos);
  EXPECT_NE(fall.reference().find("| `height_m` | m | > 0, ≤ 100 | `5.0` | Of the fall. |"), std::string::npos);
  EXPECT_EQ(fall.reference().find("`rate_Hz` |"), std::string::npos) << "tapping's page has it, with the same default";
}

TEST(RegisterExperiment, ASecondOfTheSameKindTakesThePlaceOfTheFirst) {
  register_experiment(std::make_unique<Fall>());
  const std::size_t count = experiments().size();
  auto second = std::make_unique<Fall>();
  const Experiment* const address = second.get();
  register_experiment(std::move(second));
  EXPECT_EQ(experiments().size(), count);
  EXPECT_EQ(choose_experiment(configuration::Document::parse(file, "fall.toml").value()).value(), address);
}

TEST(RunsJson, ShowsWhatAKindGaveThatIsNoObject) {
  const std::string json = runs_json(
      {.document = configuration::Document::parse("", "").value(), .variations = {}, .name = "n", .command = {}},
      {{{}, "not {json"}});
  EXPECT_EQ(Json::parse(json)["runs"][0]["not_an_object"], "not {json");
}

TEST(MetricsJson, WritesEveryDigitAndNullForWhatIsNotFinite) {
  const Json metrics =
      Json::parse(metrics_json({{"a", 0.1 + 0.2}, {"b", std::numeric_limits<double>::infinity()}}))["metrics"];
  EXPECT_EQ(metrics["a"], 0.1 + 0.2);
  EXPECT_TRUE(metrics["b"].is_null());
}

}  // namespace experiment_of_test
}  // namespace tactus::experiments
