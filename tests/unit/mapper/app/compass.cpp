#include "ocm/mapper/app/compass.hpp"

#include <limits>

#include <catch2/catch.hpp>

namespace mapper_app_compass_test {

using namespace ocm;
using mapper::app::CompassReport;
using mapper::app::CompassUse;
using mapper::app::judge;
using mapper::link::Calibration;
using motion::radians;

constexpr CompassUse usual{};
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

constexpr std::int16_t verdict(float field, float error_deg) {
  return judge(sensing::CompassFit{.field = field, .error_rad = radians(error_deg)}, usual);
}
// [docs/decisions/0029]
static_assert(verdict(0.15F, 0.0F) == Calibration::good && verdict(0.15F, 2.9F) == Calibration::good);
static_assert(verdict(0.15F, 3.1F) == Calibration::poor && verdict(0.15F, 7.9F) == Calibration::poor);
static_assert(verdict(0.15F, 8.1F) == Calibration::disturbed);
static_assert(verdict(0.049F, 0.0F) == Calibration::weak);
// Each limit is within what it limits.
static_assert(verdict(0.05F, 0.0F) == Calibration::good && verdict(0.15F, 3.0F) == Calibration::good &&
              verdict(0.15F, 8.0F) == Calibration::poor);
static_assert(judge(base::Error::not_sampled, 200) == Calibration::incomplete);
static_assert(judge(base::Error::not_sampled, 0) == Calibration::silent);
static_assert(judge(base::Error::no_answer, 200) == Calibration::silent);
static_assert(judge(base::Error::out_of_range, 200) == Calibration::weak);

TEST_CASE("mapper compass: figures that are no numbers are not good", "[mapper_compass]") {
  CHECK(judge(sensing::CompassFit{.field = 0.15F, .error_rad = nan}, usual) == Calibration::disturbed);
  CHECK(judge(sensing::CompassFit{.field = nan}, usual) == Calibration::weak);
}

TEST_CASE("mapper compass: a report as a sentence, to the nearest milligauss and degree",
          "[mapper_compass]") {
  const CompassReport report{
      .verdict = Calibration::good, .taken = true, .fit = {{0.0406F, -0.0574F}, 0.152F, radians(1.4F)}};
  CHECK(mapper::app::calibration(7, report, Calibration::stored) ==
        Calibration{7, Calibration::good, 41, -57, 152, 1, Calibration::stored});
}

TEST_CASE("mapper compass: whatever was found, the sentence can be written", "[mapper_compass]") {
  constexpr float huge = std::numeric_limits<float>::max();
  const auto said = [](float x, float y, float field, float error_rad) {
    return mapper::app::calibration(1, {.verdict = Calibration::weak, .fit = {{x, y}, field, error_rad}},
                                    Calibration::unused);
  };
  CHECK(said(2.1F, -2.1F, 2.1F, 10) ==
        Calibration{1, Calibration::weak, 2000, -2000, 2000, 180, 0});  // limits of the spec
  CHECK(said(-2.1F, 2.1F, -0.1F, -10) == Calibration{1, Calibration::weak, -2000, 2000, 0, 0, 0});
  CHECK(said(nan, nan, nan, nan) == Calibration{1, Calibration::weak, 0, 0, 0, 0, 0});
  for (const float figure : {0.0F, nan, huge, -huge, std::numeric_limits<float>::infinity()}) {
    const CompassReport report{.verdict = Calibration::disturbed, .fit = {{figure, figure}, figure, figure}};
    CHECK(mapper::link::write(mapper::app::calibration(9999, report, Calibration::unused)).ok());
  }
}

}  // namespace mapper_app_compass_test
