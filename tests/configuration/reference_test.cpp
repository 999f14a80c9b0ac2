// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/reference.hpp>

#include <string>

#include <gtest/gtest.h>
#include <tests/configuration/experiment.hpp>

namespace tactus::configuration {
namespace {

TEST(Reference, ThePageHasATablePerSection) {
  EXPECT_EQ(reference_markdown<testing::Experiment>("Experiment"), R"(# Experiment

| Key | Unit | Bounds | Default | Meaning |
|---|---|---|---|---|
| `duration_s` | s | > 0, ≤ 3600 | `2.0` | How long it runs. |

## `[slave]`

The slave.

| Key | Unit | Bounds | Default | Meaning |
|---|---|---|---|---|
| `mass_kg` | kg | > 0 | `0.5` | Moving mass. |
| `offset_m` | m | any | `0.0` | Where it rests \| at the start. |
| `stiffness_N_per_m` | N/m | ≥ 0 | `3950.0` | Stiffness. |

## `[slave.velocity_filter]`

Filters the measured velocity.

| Key | Unit | Bounds | Default | Meaning |
|---|---|---|---|---|
| `cutoff_Hz` | Hz | > 0, ≤ 20000 | `80.0` | The -3 dB point. |
| `enabled` |  | `true`, `false` | `true` | Whether it filters at all. |

## `[control]`

The controller.

| Key | Unit | Bounds | Default | Meaning |
|---|---|---|---|---|
| `force_gain` |  | ≥ 0, ≤ 10 | `1.0` | Force scale. |
| `cancellation` |  | `off`, `model`, `adaptive` | `"model"` | How the induced motion is cancelled. |
| `taps` |  | whole, ≥ 1, ≤ 4096 | `32` | Number of taps. |
| `seed` |  | whole | `1` | Seed of the noise. |

## `[task]`

The task.

| Key | Unit | Bounds | Default | Meaning |
|---|---|---|---|---|
| `kind` |  | text | `"tapping"` | What is done. |
| `recording` |  | text | `""` | File of a recording. |
)");
}

struct Axis {
  double gain = 1.0;
  bool moves = true;
  static constexpr auto fields() {
    return List{field("gain", &Axis::gain, units::none, positive, "Its gain."),
                field("moves", &Axis::moves, "Whether it moves.")};
  }
};
struct Table {
  Axis axis_1, axis_2{.gain = 2.5}, axis_3, other_1;
  static constexpr auto fields() {
    return List{field("axis_1", &Table::axis_1, "The lowest."), field("axis_2", &Table::axis_2, "The middle."),
                field("axis_3", &Table::axis_3, "The highest."), field("other_1", &Table::other_1, "Another.")};
  }
};
struct NumberedExperiment {
  Table table;
  static constexpr auto fields() { return List{field("table", &NumberedExperiment::table, "The table.")}; }
};

TEST(Reference, NumberedSectionsShareATable) {
  EXPECT_EQ(reference_markdown<NumberedExperiment>("Numbered"), R"(# Numbered

## `[table]`

The table.

## `[table.axis_1]` to `axis_3`

`axis_1`: The lowest.

| Key | Unit | Bounds | Default | Meaning |
|---|---|---|---|---|
| `gain` |  | > 0 | `1.0`, `2.5`, `1.0` | Its gain. |
| `moves` |  | `true`, `false` | `true` | Whether it moves. |

## `[table.other_1]`

Another.

| Key | Unit | Bounds | Default | Meaning |
|---|---|---|---|---|
| `gain` |  | > 0 | `1.0` | Its gain. |
| `moves` |  | `true`, `false` | `true` | Whether it moves. |
)");
}

struct Machine {
  Axis axis;
  double mass_kg = 2.0;
  static constexpr auto fields() {
    return List{field("axis", &Machine::axis, "It turns."),
                field("mass_kg", &Machine::mass_kg, units::kilogram, positive, "What it weighs.")};
  }
};
struct TwinExperiment {
  Machine left, right, heavy{.axis = {}, .mass_kg = 5.0};
  static constexpr auto fields() {
    return List{field("left", &TwinExperiment::left, "One."), field("right", &TwinExperiment::right, "The other."),
                field("heavy", &TwinExperiment::heavy, "A third.")};
  }
};

TEST(Reference, ASectionThatIsAnEarlierOneAgainRefersToIt) {
  EXPECT_EQ(reference_markdown<TwinExperiment>("Twins"), R"(# Twins

## `[left]`

One.

| Key | Unit | Bounds | Default | Meaning |
|---|---|---|---|---|
| `mass_kg` | kg | > 0 | `2.0` | What it weighs. |

## `[left.axis]`

It turns.

| Key | Unit | Bounds | Default | Meaning |
|---|---|---|---|---|
| `gain` |  | > 0 | `1.0` | Its gain. |
| `moves` |  | `true`, `false` | `true` | Whether it moves. |

## `[right]`

The other.

Keys and defaults of `[left]`.

## `[heavy]`

A third.

| Key | Unit | Bounds | Default | Meaning |
|---|---|---|---|---|
| `mass_kg` | kg | > 0 | `5.0` | What it weighs. |

## `[heavy.axis]`

It turns.

Keys and defaults of `[left.axis]`.
)");
}

struct StifferExperiment : testing::Experiment {
  double stay_s = 1.0;
  StifferExperiment() { slave.stiffness_N_per_m = 5000.0; }
  static constexpr auto fields() {
    return joined(testing::Experiment::fields(),
                  List{field("stay_s", &StifferExperiment::stay_s, units::second, positive, "How long it stays.")});
  }
};

TEST(Reference, WhatAnotherPageSaysIsLeftToIt) {
  const std::string page = reference_beside<StifferExperiment, testing::Experiment>("Stiffer", "soft");
  EXPECT_EQ(page, R"(# Stiffer

Same as in [`soft`](soft.md), with the same defaults: `[slave.velocity_filter]`, `[control]`, `[task]`.

## Keys at the top of the file

| Key | Unit | Bounds | Default | Meaning |
|---|---|---|---|---|
| `stay_s` | s | > 0 | `1.0` | How long it stays. |

Same as in [`soft`](soft.md): `duration_s`.

## `[slave]`

The slave.

| Key | Unit | Bounds | Default | Meaning |
|---|---|---|---|---|
| `stiffness_N_per_m` | N/m | ≥ 0 | `5000.0` | Stiffness. |

Same as in [`soft`](soft.md): `mass_kg`, `offset_m`.
)");
}

}  // namespace
}  // namespace tactus::configuration
