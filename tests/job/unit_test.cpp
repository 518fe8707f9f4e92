#include "trebsweep/job/unit.hpp"

#include <fmt/format.h>

#include "job/parse.hpp"
#include "support/catch.hpp"
#include "trebsweep/base/error.hpp"
#include "trebsweep/job/key.hpp"
#include "trebsweep/swing/field.hpp"

#if __has_include(<udunits2.h>)
#include <udunits2.h>
#endif

using namespace trebsweep;

namespace {

double in_metres(const std::string& text) {
  return to_number("scene.fulcrum-height", text, physical, "m");
}

}  // namespace

#if __has_include(<udunits2.h>)
namespace {

/// Releases a unit of UDUNITS-2.
struct FreeUnit {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};
using UdUnit = std::unique_ptr<ut_unit, FreeUnit>;

/// The factor of UDUNITS-2 from one unit to another; NaN if their dimensions differ.
double udunits_factor(ut_system* system, const std::string& from, const std::string& to) {
  const UdUnit a(ut_parse(system, from.c_str(), UT_ASCII));
  const UdUnit b(ut_parse(system, to.c_str(), UT_ASCII));
  INFO(from << " to " << to);
  REQUIRE(a);
  REQUIRE(b);
  if (!ut_are_convertible(a.get(), b.get())) return NAN;
  cv_converter* const converter = ut_get_converter(a.get(), b.get());
  const double factor = cv_convert_double(converter, 1);
  cv_free(converter);
  return factor;
}

/// The SI unit of a dimension, for UDUNITS-2.
std::string si_unit(const std::array<int, 4>& dimension) {
  return fmt::format("kg{} m{} s{} rad{}", dimension[0], dimension[1], dimension[2], dimension[3]);
}

}  // namespace

TEST_CASE("Units have the dimensions and factors of UDUNITS-2") {
  ut_set_error_message_handler(ut_ignore);
  ut_system* const system = ut_read_xml(nullptr);
  REQUIRE(system);
  // Those that UDUNITS-2 does not have under the same name.
  const std::map<std::string, std::string> other_names{
      {"oz", "lb/16"}, {"deg", "degree"}, {"mph", "mile/hour"}, {"kph", "km/hour"},
      {"fps", "ft/s"}, {"kn", "knot"},    {"lbs", "lb"}};
  std::vector<std::pair<std::string, std::string>> all;  // in our and in its notation
  for (const NamedUnit& unit : named_units()) {
    const auto other = other_names.find(std::string(unit.name));
    all.emplace_back(unit.name, other == other_names.end() ? unit.name : other->second);
  }
  CHECK(all.size() >= 40);
  for (const std::string text : {"lb/ft^3", "lb ft2", "ft/s", "ft lbf", "N m s/rad", "kg m^2",
                                 "m s-1", "lb/in^2/ft", "kg*m^2/s^2", "g/cm^3", "in^3", "km/h"})
    all.emplace_back(text, text);
  for (const auto& [ours, theirs] : all) {
    INFO(ours);
    const auto unit = to_unit(ours);
    REQUIRE(unit);
    CHECK(unit->factor ==
          Approx(udunits_factor(system, theirs, si_unit(unit->dimension))).epsilon(1e-15));
  }
  ut_free_system(system);
}
#endif

TEST_CASE("A number may have a unit, with or without a space, and is SI without one") {
  CHECK(in_metres("3.5 ft") == 3.5 * 0.3048);
  CHECK(in_metres("3.5ft") == in_metres(" +3.5  ft "));
  CHECK(in_metres("4 ft 3 in") == in_metres("4.25 ft"));
  CHECK(in_metres("4ft 3.5in") == 51.5 * 0.0254);
  for (const char* text :
       {"4 ft 12 in", "4 ft -3 in", "-4 ft 3 in", "4 ft 3", "4 ft 3 in 2 in", "4 in 3 ft"})
    CHECK_THROWS_AS(in_metres(text), InputError);
  CHECK(in_metres("1e2 cm") == 1);
  CHECK(in_metres("1.5 in") == 0.0381);  // 1.5 * 0.0254 is not quite that
  CHECK(in_metres("2") == 2);
  CHECK(to_number("pin", "180 deg", positive, "rad") == 3.141592653589793);
  CHECK(to_number("pin", "45deg", positive, "rad") == 3.141592653589793 / 4);
  CHECK(to_number("density", "1 g/cm^3", positive, "kg/m^3") == Approx(1000).epsilon(1e-15));
}

TEST_CASE("The message about a number outside its range names key, value and range") {
  CHECK(to_number("mass", "2", positive, "kg") == 2);
  CHECK(to_number("mass", "0", not_negative, "kg") == 0);
  CHECK_THROWS_WITH(to_number("mass", "0", positive, "kg"),
                    "mass = 0: must be a finite number above 0");
  CHECK_THROWS_WITH(to_number("mass", "-0.1", not_negative, "kg"),
                    "mass = -0.1: must be a finite number of at least 0");
  CHECK_THROWS_WITH(to_number("level", "10", Range{0, 9}, ""),
                    "level = 10: must be a number from 0 to 9");
  CHECK_THROWS_WITH(to_number("angle", "2", Range{0, 2, false}, ""),
                    "angle = 2: must be a number above 0 and below 2");
  CHECK(to_number("mass", "0", physical_or_zero, "") == 0);
  CHECK_THROWS_WITH(to_number("mass", "1e-13", physical_or_zero, ""),
                    "mass = 1e-13: must be 0, or a number from 1e-12 to 1e+12");
  CHECK_THROWS_WITH(to_number("mass", "0", physical, ""),
                    "mass = 0: must be a number above 0, from 1e-12 to 1e+12");
  for (const std::string value : {"nan", "inf", "-inf"})
    CHECK_THROWS_AS(to_number("mass", value, positive, "kg"), InputError);
}

TEST_CASE("A text that is not a product of powers of known units is no unit") {
  for (const char* text : {"", " ", "parsec", "m^", "m^10", "m^^2", "/s", "m/", "m//s", "m s-", "2",
                           "m 2", "(m)", "M"})
    CHECK_FALSE(to_unit(text));
}

TEST_CASE("A unit of another dimension is refused, naming those that are allowed") {
  CHECK_THROWS_WITH(in_metres("60 lb"),
                    "scene.fulcrum-height = 60 lb: must be a number above 0, from 1e-12 to 1e+12, "
                    "in one of the units m, mm, cm, km, in, ft, yd, mi");
  CHECK_THROWS_WITH(in_metres("60 parsec"), contains("in one of the units m, mm"));
  CHECK_THROWS_WITH(
      in_metres("1e13 ft"),
      "scene.fulcrum-height = 1e13 ft: must be a number above 0, from 1e-12 to 1e+12, in m");
  CHECK_THROWS_WITH(to_number("rho", "1 kg", positive, "kg/m^3"),
                    contains("in kg/m^3 or another unit of that dimension"));
  CHECK_THROWS_WITH(to_number("drag", "1 m", positive, ""),
                    "drag = 1 m: must be a finite number above 0, without a unit");
}

TEST_CASE("Every key with a unit refuses a number of another dimension and takes one of its own") {
  for (const Key& key : job_keys()) {
    if (key.placeholder != "NUMBER" && key.placeholder != "RANGE") continue;
    INFO(key.name);
    REQUIRE((key.unit.empty() || to_unit(key.unit)));
    CHECK_THROWS_AS(parse("", {{key.name, "1 kg^3"}}), InputError);
    Job plain, with_unit;
    key.set(plain, "0.01");
    key.set(with_unit, "0.01 " + key.unit);
    CHECK(key.get(plain) == key.get(with_unit));
  }
}

TEST_CASE("Ranges and lists have a unit for each number, or for none") {
  const auto axis_text = [](const std::string& value) {
    return parse("[scene]\nfulcrum-height = " + value).outer_axes.at(0).text;
  };
  CHECK(axis_text("3 m:4 m:50 cm") == "3:4:0.5");
  CHECK(axis_text("400 cm, 3 m") == "3, 4");
  CHECK_THROWS_WITH(axis_text("3:4 m:0.5"),
                    contains("numbers of which each has a unit, or none has"));
  CHECK_THROWS_WITH(axis_text("3, 4 ft"),
                    contains("numbers of which each has a unit, or none has"));
  const Job job = parse("[lattice]\nr1 = 2 ft:4 ft:3 in\n[assess]\ntime-steps = 10 ms, 1ms\n");
  CHECK(job.lattice.r1->step == Approx(0.0762));
  CHECK(job.assess.time_steps == std::vector{0.01, 0.001});
  CHECK(parse("[assess]\ntime-steps = 0.1 0.01, 0.001\n").assess.time_steps.size() == 3);
  CHECK(parse("[assess]\ntime-steps = 3 ms\n").assess.time_steps == std::vector{0.003});
  CHECK_THROWS_WITH(parse("[assess]\ntime-steps = 1, 2 ms\n"),
                    contains("numbers of which each has a unit, or none has"));
}

TEST_CASE("The limit of a constraint may have a unit of its field's dimension") {
  const auto limit = [](const std::string& text) {
    return parse("[optimum]\nsubject-to = " + text).optimum.constraints.at(0).limit;
  };
  CHECK(limit("range >= 100 yd") == Approx(91.44));
  CHECK(limit("speed >= 90 km/h") == Approx(25));
  CHECK(limit("peak-beam-stress <= 20 MPa") == 2e7);
  CHECK(limit("efficiency >= 70 %") == Approx(0.7));
  CHECK(limit("peak-axle-load <= 1000 lbf") == Approx(4448.2216));
  CHECK_THROWS_WITH(limit("range >= 5 kg"),
                    contains("where NUMBER is finite, in one of the units m, "));
}

TEST_CASE("The laboratory machine in feet, pounds and degrees is the same job to 12 digits") {
  const auto rounded = [](Job job) {
    for (const Key& key : job_keys()) {
      double number = 0;
      if (const std::string value = key.get(job);
          key.section() == "scene" && parse_number(value, number))
        key.set(job, fmt::format("{:.12g}", number));
    }
    return to_text(job);
  };
  std::string customary = "[scene]\ntrough = yes\n";
  const auto in = [](double value, const std::string& unit) {
    return fmt::format("{:.15g} {}", value / to_unit(unit)->factor, unit);
  };
  for (const auto& [key, value, unit] :
       std::initializer_list<std::tuple<std::string, double, std::string>>{
           {"gravity", 9.81, "ft/s^2"},
           {"counterweight-mass", 53.9, "lb"},
           {"projectile-mass", 0.717, "oz"},
           {"fulcrum-height", 0.831, "in"},
           {"counterweight-hanger", 0.515, "ft"},
           {"start-angle", 0.55, "deg"},
           {"beam-mass", 4.86, "lb"},
           {"beam-centre", 0.465, "ft"},
           {"beam-moment", 1.85, "lb ft^2"}})
    customary += fmt::format("{} = {}\n", key, in(value, unit));
  const Job lab = parse("[scene]\nfile = " SOURCE_DIR "/jobs/scenes/laboratory.cfg\n");
  CHECK(rounded(parse(customary)) == rounded(lab));
}

TEST_CASE("A number that is shown in another unit is read as the same number") {
  for (const UnitSystem system : {UnitSystem::si, UnitSystem::us, UnitSystem::deg})
    for (const FieldInfo& field : field_info) {
      const auto [name, factor] = shown_unit(field.units, system);
      if (name.empty()) continue;
      INFO(name);
      CHECK(to_si(fmt::format("{} {}", 12.5 / factor, name), field.units).value() ==
            Approx(12.5).epsilon(1e-14));
    }
  CHECK(shown_unit("m", UnitSystem::us).name == "ft");
  CHECK(shown_unit("m s-1", UnitSystem::us).name == "mph");
  CHECK(shown_unit("rad", UnitSystem::deg).name == "deg");
  CHECK(shown_unit("m s-1", UnitSystem::deg).name == "m/s");
}

TEST_CASE("The unit of the SI of a unit has its dimension, and the factor one") {
  for (const NamedUnit& named : named_units()) {
    const std::string si = si_unit(named.unit);
    INFO(named.name);
    if (named.name == "%") {
      CHECK(si.empty());
      continue;
    }
    REQUIRE(to_unit(si));
    CHECK(to_unit(si)->factor == 1);
    CHECK(to_unit(si)->dimension == named.unit.dimension);
  }
}
