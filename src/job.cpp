#include "trebsweep/job.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <boost/algorithm/string.hpp>
#include <boost/math/constants/constants.hpp>
#include <boost/program_options.hpp>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "trebsweep/error.hpp"
#include "trebsweep/number.hpp"

namespace trebsweep {
namespace {

namespace po = boost::program_options;

/// A key with a number; `member` gives the place of it in a Job.
template <class Member>
Key number(const std::string& name, const std::string& help, const Range& range, Member member) {
  return {name, fmt::format("{}; {}", help, range.text()),
          [=](Job& job, const std::string& value) { member(job) = to_number(name, value, range); },
          [=](const Job& job) { return fmt::format("{}", member(job)); }};
}

template <class Member>
Key whole_number(const std::string& name, const std::string& help, std::uint64_t low,
                 std::uint64_t high, Member member) {
  const std::string allowed = fmt::format("a whole number from {} to {}", low, high);
  return {name, fmt::format("{}; {}", help, allowed),
          [=](Job& job, const std::string& value) {
            std::uint64_t n = 0;
            if (!parses(value, n) || n < low || n > high) refuse(name, value, allowed);
            member(job) = static_cast<std::decay_t<decltype(member(job))>>(n);
          },
          [=](const Job& job) { return fmt::format("{}", member(job)); }};
}

/// The words of a list, which commas, blanks or both divide.
std::vector<std::string> to_words(const std::string& value) {
  std::vector<std::string> words;
  boost::split(words, boost::trim_copy(value), boost::is_any_of(", "), boost::token_compress_on);
  return words;
}

/// A key with a list of numbers, at least one.
template <class Member>
Key numbers(const std::string& name, const std::string& help, const Range& range, Member member) {
  return {name, fmt::format("{}; a list, each {}", help, range.text()),
          [=](Job& job, const std::string& value) {
            member(job).clear();
            for (const std::string& word : to_words(value))
              member(job).push_back(to_number(name, word, range));
          },
          [=](const Job& job) { return fmt::format("{}", fmt::join(member(job), ", ")); }};
}

/// A key with a list of paths.
template <class Member>
Key paths(const std::string& name, const std::string& help, Member member) {
  return {name, help,
          [=](Job& job, const std::string& value) {
            member(job).clear();
            for (const std::string& word : to_words(value))
              if (!word.empty()) member(job).push_back(word);
          },
          [=](const Job& job) { return fmt::format("{}", fmt::join(member(job), ", ")); }};
}

template <class Names>
std::size_t to_choice(const std::string& key, const std::string& value, const Names& names) {
  const auto found = std::find(names.begin(), names.end(), value);
  if (found == names.end()) refuse(key, value, fmt::format("one of {}", fmt::join(names, ", ")));
  return static_cast<std::size_t>(found - names.begin());
}

/// A key with one of the names of an enumeration, in its order.
template <class Names, class Member>
Key choice(const std::string& name, const std::string& help, const Names& names, Member member) {
  return {
      name, fmt::format("{}; one of {}", help, fmt::join(names, ", ")),
      [=](Job& job, const std::string& value) {
        using Choice = std::decay_t<decltype(member(job))>;
        member(job) = static_cast<Choice>(to_choice(name, value, names));
      },
      [=](const Job& job) { return std::string(names[static_cast<std::size_t>(member(job))]); }};
}

Key stepper_key() {
  return {"solver.stepper",
          fmt::format("method of integration; one of {}", fmt::join(stepper_names, ", ")),
          [](Job& job, const std::string& value) {
            job.solver.stepper = stepper_names[to_choice("solver.stepper", value, stepper_names)];
          },
          [](const Job& job) { return job.solver.stepper; }};
}

Key target_key() {
  const std::string name = "solver.target-error";
  return {name,
          fmt::format("error of the speeds, m/s, to choose the tolerance by, from a sample; {}",
                      positive.text()),
          [=](Job& job, const std::string& value) {
            job.solver.target_error = to_number(name, value, positive);
          },
          [](const Job& job) {
            return job.solver.target_error > 0 ? fmt::format("{}", job.solver.target_error) : "";
          }};
}

Key steppers_key() {
  const std::string name = "assess.steppers";
  return {name, fmt::format("a list of {}", fmt::join(stepper_names, ", ")),
          [=](Job& job, const std::string& value) {
            std::vector<std::string> steppers;
            for (const std::string& word : to_words(value)) {
              steppers.emplace_back(stepper_names[to_choice(name, word, stepper_names)]);
              if (std::count(steppers.begin(), steppers.end(), word) > 1)
                refuse(name, value, "a list without repetition");
            }
            job.assess.steppers = steppers;
          },
          [](const Job& job) { return fmt::format("{}", fmt::join(job.assess.steppers, ", ")); }};
}

AxisRange to_axis(const std::string& key, const std::string& value) {
  const std::string allowed =
      "first:last:step or a single value, in metres, with 0 < first <= last and step > 0";
  std::vector<std::string> parts;
  boost::split(parts, value, boost::is_any_of(":"));
  std::vector<double> numbers;
  for (const std::string& part : parts) {
    double x = 0;
    if (!parses(part, x) || !positive.contains(x)) refuse(key, value, allowed);
    numbers.push_back(x);
  }
  if (numbers.size() == 1) return {numbers[0], numbers[0], 1};
  if (numbers.size() != 3 || numbers[0] > numbers[1]) refuse(key, value, allowed);
  return {numbers[0], numbers[1], numbers[2]};
}

template <class Member>
Key axis(const std::string& name, const std::string& help, Member member) {
  return {name, help + ", as first:last:step (both ends included) or a single value, m",
          [=](Job& job, const std::string& value) { member(job) = to_axis(name, value); },
          [=](const Job& job) -> std::string {
            const auto& range = member(job);
            if (!range) return "";
            if (range->first == range->last) return fmt::format("{}", range->first);
            return fmt::format("{}:{}:{}", range->first, range->last, range->step);
          }};
}

std::vector<std::string_view> field_names() {
  std::vector<std::string_view> names;
  for (const FieldInfo& field : field_info) names.push_back(field.name);
  return names;
}

Key fields_key() {
  const std::string name = "output.fields";
  const std::string allowed =
      fmt::format("a list, without repetition, of {}", fmt::join(field_names(), ", "));
  return {name, "maps to store; " + allowed,
          [=](Job& job, const std::string& value) {
            std::vector<Field> fields;
            for (const std::string& word : to_words(value)) {
              const auto names = field_names();
              const auto found = std::find(names.begin(), names.end(), word);
              const auto field = static_cast<Field>(found - names.begin());
              if (found == names.end() || std::count(fields.begin(), fields.end(), field))
                refuse(name, value, allowed);
              fields.push_back(field);
            }
            job.output.fields = fields;
          },
          [](const Job& job) {
            std::vector<std::string_view> names;
            for (const Field field : job.output.fields) names.push_back(info(field).name);
            return fmt::format("{}", fmt::join(names, ", "));
          }};
}

Key file_key() {
  return {"output.file", "path of the archive; by default the job file's name with .h5, here",
          [](Job& job, const std::string& value) {
            // A job file takes what follows a # for a comment: its text could not be read back.
            if (value.empty() || value.find_first_of("#\n") != std::string::npos)
              refuse("output.file", value, "a path without # and line breaks");
            job.output.file = value;
          },
          [](const Job& job) { return job.output.file; }};
}

std::vector<Key> make_keys() {
  constexpr double pi = boost::math::double_constants::pi;
  constexpr std::array inertias{"slender", "prism", "none"};
  constexpr std::array releases{"crossing", "window"};
  constexpr std::array storages{"float64", "float32"};
  constexpr std::array contests{"all", "taut"};
  return {
      number(
          "scene.gravity", "gravitational acceleration g, m/s^2", positive,
          [](auto& job) -> auto& { return job.scene.gravity; }),
      number(
          "scene.counterweight-mass", "m1, kg", positive,
          [](auto& job) -> auto& { return job.scene.counterweight_mass; }),
      number(
          "scene.projectile-mass", "m3, kg", positive,
          [](auto& job) -> auto& { return job.scene.projectile_mass; }),
      number(
          "scene.release-height", "height h of the counterweight at the start, m", positive,
          [](auto& job) -> auto& { return job.scene.release_height; }),
      number(
          "scene.fulcrum-height", "height h0 of the fulcrum, m", positive,
          [](auto& job) -> auto& { return job.scene.fulcrum_height; }),
      number(
          "scene.beam-density", "density of the beam, kg/m^3", not_negative,
          [](auto& job) -> auto& { return job.scene.beam_density; }),
      number(
          "scene.beam-side", "side of the beam's square section, m", not_negative,
          [](auto& job) -> auto& { return job.scene.beam_side; }),
      choice(
          "scene.beam-inertia", "moment of inertia of the beam", inertias,
          [](auto& job) -> auto& { return job.scene.beam_inertia; }),
      number(
          "scene.sling-angle", "phi2 at the start, rad; 0 hangs straight down", Range{-pi, pi},
          [](auto& job) -> auto& { return job.scene.sling_angle; }),
      number(
          "scene.pivot-viscosity", "torque against the beam's turning, per rate, N m s/rad",
          not_negative, [](auto& job) -> auto& { return job.scene.pivot_viscosity; }),
      number(
          "scene.pivot-friction", "dry torque against it, which also holds a beam at rest, N m",
          not_negative, [](auto& job) -> auto& { return job.scene.pivot_friction; }),
      number(
          "scene.sling-mass", "mass of the sling, spread evenly, kg", not_negative,
          [](auto& job) -> auto& { return job.scene.sling_mass; }),
      number(
          "scene.sling-stiffness", "force per stretch of an elastic sling, N/m; 0: rigid",
          not_negative, [](auto& job) -> auto& { return job.scene.sling_stiffness; }),
      number(
          "scene.sling-damping", "force per rate of its stretch, N s/m", not_negative,
          [](auto& job) -> auto& { return job.scene.sling_damping; }),
      number(
          "lattice.increment", "step of the lattice dr, m", positive,
          [](auto& job) -> auto& { return job.lattice.increment; }),
      number(
          "lattice.shortest-sling", "where r3 begins, m", positive,
          [](auto& job) -> auto& { return job.lattice.shortest_sling; }),
      axis(
          "lattice.r1", "counterweight's arms instead of h - h0 < r1 < h0",
          [](auto& job) -> auto& { return job.lattice.r1; }),
      axis(
          "lattice.r3", "slings instead of shortest-sling <= r3 < h0",
          [](auto& job) -> auto& { return job.lattice.r3; }),
      axis(
          "lattice.r2", "throwing arms instead of 0 < r2 < h0 - r3",
          [](auto& job) -> auto& { return job.lattice.r2; }),
      stepper_key(),
      number(
          "solver.time-step", "a fixed stepper's step, s; adaptive ones find their own", positive,
          [](auto& job) -> auto& { return job.solver.time_step; }),
      number(
          "solver.tolerance", "error allowed in one adaptive step, absolute and relative",
          Range{1e-15, 0.1}, [](auto& job) -> auto& { return job.solver.tolerance; }),
      target_key(),
      choice(
          "solver.release",
          "crossing: phi1 = pi, met exactly; window: first step with |pi - phi1| < "
          "release-window, for fixed steppers only (if nothing is said, adaptive ones use "
          "crossing)",
          releases, [](auto& job) -> auto& { return job.solver.release; }),
      number(
          "solver.release-window", "the paper's window, rad", positive,
          [](auto& job) -> auto& { return job.solver.release_window; }),
      number(
          "solver.max-time", "swings not released by then are given up, s", positive,
          [](auto& job) -> auto& { return job.solver.max_time; }),
      whole_number(
          "solver.max-steps", "steps tried per swing before it is given up", 1, 1000000000000,
          [](auto& job) -> auto& { return job.solver.max_steps; }),
      file_key(),
      fields_key(),
      choice(
          "output.optimum", "shots that compete for the optimum: all, or those with a taut sling",
          contests, [](auto& job) -> auto& { return job.output.contest; }),
      choice(
          "output.storage", "number type of the maps", storages,
          [](auto& job) -> auto& { return job.output.storage; }),
      whole_number(
          "output.compression", "deflate level of the maps, 0 = off", 0, 9,
          [](auto& job) -> auto& { return job.output.compression; }),
      paths(
          "assess.scenes", "scene or job files to look at; none: the job's own scene",
          [](auto& job) -> auto& { return job.assess.scenes; }),
      paths(
          "assess.extremes", "the same, with one setting per stepper",
          [](auto& job) -> auto& { return job.assess.extremes; }),
      steppers_key(),
      numbers(
          "assess.time-steps", "steps to try, s", positive,
          [](auto& job) -> auto& { return job.assess.time_steps; }),
      numbers(
          "assess.tolerances", "tolerances to try", Range{1e-15, 0.1},
          [](auto& job) -> auto& { return job.assess.tolerances; }),
      whole_number(
          "assess.designs", "designs of a scene's lattice, beside its corners and its optimum", 1,
          100000, [](auto& job) -> auto& { return job.assess.designs; }),
      whole_number(
          "assess.repeats", "runs of which the median time counts", 1, 1000,
          [](auto& job) -> auto& { return job.assess.repeats; }),
      number(
          "assess.target-error", "error of the speed that advice is given for, m/s", positive,
          [](auto& job) -> auto& { return job.assess.target_error; }),
      number(
          "assess.lattice-seconds", "longest run over the first scene's whole lattice; 0: none",
          not_negative, [](auto& job) -> auto& { return job.assess.lattice_seconds; }),
  };
}

/// The steps of an adaptive stepper leap over the window, or land in it on a later pass: it needs
/// the crossing, which it gets unless the job says otherwise.
void settle_release(Solver& solver, bool given) {
  if (!follows_tolerance(solver.stepper) || solver.release == Release::crossing) return;
  if (given)
    refuse("solver.release", "window",
           fmt::format("crossing for the adaptive stepper {}, whose steps may leap over the window",
                       solver.stepper));
  solver.release = Release::crossing;
}

/// A target error stands for a tolerance.
void check_target(const Solver& solver, bool tolerance_given) {
  const std::string value = fmt::format("{}", solver.target_error);
  if (tolerance_given)
    refuse("solver.target-error", value, "given without solver.tolerance, which it chooses");
  if (!follows_tolerance(solver.stepper))
    refuse(
        "solver.target-error", value,
        fmt::format("given with a stepper that follows a tolerance, not with {}", solver.stepper));
}

/// Refuses keys that are each allowed but make no sense together.
void check(const Job& job) {
  if (job.scene.sling_damping > 0 && job.scene.sling_stiffness == 0)
    refuse("scene.sling-damping", fmt::format("{}", job.scene.sling_damping),
           "0 without a sling-stiffness above 0: a rigid sling has no stretch to damp");
  const auto& fields = job.output.fields;
  if (job.scene.beam_side == 0 &&
      std::count(fields.begin(), fields.end(), Field::peak_beam_stress) > 0)
    refuse("output.fields", "peak-beam-stress",
           "fields without peak-beam-stress where scene.beam-side is 0: no section bears it");
}

std::string section_of(const std::string& name) { return name.substr(0, name.find('.')); }

std::string key_of(const std::string& name) { return name.substr(name.find('.') + 1); }

[[noreturn]] void refuse_unknown(const std::string& name) {
  std::vector<std::string> known;
  for (const Key& key : job_keys())
    if (section_of(key.name) == section_of(name)) known.push_back(key_of(key.name));
  if (section_of(name) == "scene") known.push_back("file");
  if (known.empty())
    throw InputError(fmt::format(
        "{}: unknown key; the sections are scene, lattice, solver, output, assess", name));
  throw InputError(fmt::format("{}: unknown key; the keys of [{}] are {}", name, section_of(name),
                               fmt::join(known, ", ")));
}

po::options_description file_options() {
  po::options_description options;
  for (const Key& key : job_keys())
    options.add_options()(key.name.c_str(), po::value<std::string>());
  return options;
}

/// Refuses lines that are no section and no key. Here, since Boost's own message about them never
/// ends where they hold its placeholders, such as %invalid_line%.
void check_lines(const std::string& text, const std::string& name) {
  std::istringstream stream(text);
  std::string line;
  for (int number = 1; std::getline(stream, line); ++number) {
    std::string said = line.substr(0, line.find('#'));
    boost::trim(said);
    const bool is_section = said.starts_with('[') && said.ends_with(']');
    if (!said.empty() && !is_section && said.find('=') == std::string::npos)
      throw InputError(fmt::format(
          "job file {}: line {}, '{}', is neither [section] nor key = value", name, number, said));
  }
}

po::variables_map parse_text(const std::string& text, const std::string& name,
                             const po::options_description& options) {
  check_lines(text, name);
  po::variables_map given;
  try {
    std::istringstream stream(text);
    po::store(po::parse_config_file(stream, options), given);
  } catch (const po::unknown_option& unknown) {
    refuse_unknown(unknown.get_option_name());
  } catch (const po::error& error) {
    throw InputError(fmt::format("job file {}: {}", name, error.what()));
  }
  return given;
}

/// Sets the keys of a scene file, which has none but those of a scene.
void set_scene(Job& job, const std::string& path) {
  const auto given = parse_text(read_job_file(path), path, file_options());
  for (const Key& key : job_keys()) {
    if (!given.count(key.name)) continue;
    if (section_of(key.name) != "scene")
      refuse(scene_file, path, fmt::format("a file of [scene] alone, without {}", key.name));
    key.set(job, given[key.name].as<std::string>());
  }
}

}  // namespace

const std::vector<Key>& job_keys() {
  static const std::vector<Key> keys = make_keys();
  return keys;
}

Job parse_job(const std::string& text, const std::string& name, const Overrides& overrides) {
  auto options = file_options();
  options.add_options()(scene_file.c_str(), po::value<std::string>());
  const auto given = parse_text(text, name, options);
  Job job;
  if (overrides.count(scene_file))
    set_scene(job, overrides.at(scene_file));
  else if (given.count(scene_file))
    set_scene(job, std::filesystem::path(name).parent_path() / given[scene_file].as<std::string>());
  bool release_given = false, tolerance_given = false;
  for (const Key& key : job_keys()) {
    const auto override = overrides.find(key.name);
    const bool overridden = override != overrides.end();
    if (!overridden && !given.count(key.name)) {
      if (key.name == "output.file")
        key.set(job, std::filesystem::path(name).stem().string() + ".h5");
      continue;
    }
    key.set(job, overridden ? override->second : given[key.name].as<std::string>());
    release_given = release_given || key.name == "solver.release";
    tolerance_given = tolerance_given || key.name == "solver.tolerance";
  }
  settle_release(job.solver, release_given);
  if (job.solver.target_error > 0) check_target(job.solver, tolerance_given);
  check(job);
  // Files that the job names lie beside it; those of options, as usual, where the user is.
  const auto place = [&](const char* key, std::vector<std::string>& paths) {
    if (overrides.count(key)) return;
    for (std::string& path : paths) path = std::filesystem::path(name).parent_path() / path;
  };
  place("assess.scenes", job.assess.scenes);
  place("assess.extremes", job.assess.extremes);
  return job;
}

std::string read_job_file(const std::string& path) {
  const auto refuse_file = [&](const std::string& why) {
    throw InputError(
        fmt::format("job file {}: {}; give the path of a readable text file", path, why));
  };
  std::error_code unknown;  // then opening it tells why
  if (std::filesystem::is_directory(path, unknown)) refuse_file("is a directory");
  std::ifstream file(path, std::ios::binary);
  if (!file) refuse_file(std::strerror(errno));
  constexpr std::size_t longest = 1 << 20;
  std::string content(longest + 1, '\0');
  file.read(content.data(), static_cast<std::streamsize>(content.size()));
  if (file.bad()) refuse_file(std::strerror(errno));
  content.resize(static_cast<std::size_t>(file.gcount()));
  if (content.starts_with("\xef\xbb\xbf")) content.erase(0, 3);  // a byte-order mark
  const bool binary = std::any_of(content.begin(), content.end(), [](unsigned char c) {
    return c < ' ' && c != '\n' && c != '\r' && c != '\t';
  });
  if (binary) refuse_file("is not a text file");
  if (content.size() > longest) refuse_file("is longer than 1 MiB");
  return content;
}

std::string to_text(const Job& job, bool with_assessment) {
  std::string text, section;
  for (const Key& key : job_keys()) {
    const std::string value = key.get(job);
    if (value.empty() || (section_of(key.name) == "assess" && !with_assessment)) continue;
    if (key.name == "solver.tolerance" && job.solver.target_error > 0) continue;  // not chosen yet
    if (section != section_of(key.name)) {
      section = section_of(key.name);
      text += fmt::format("{}[{}]\n", text.empty() ? "" : "\n", section);
    }
    text += fmt::format("{} = {}\n", key_of(key.name), value);
  }
  return text;
}

}  // namespace trebsweep
