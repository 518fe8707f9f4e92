// The WebAssembly module of the explorer: the equations, steppers and swings of the numerical core,
// called with numbers in shared arrays. Scene and solver are set key by key.

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "job_keys.hpp"
#include "trace.hpp"

namespace trebsweep::explorer {
namespace {

constexpr std::size_t max_designs = 4096, max_fields = field_info.size();
std::array<Design<double>, max_designs> designs;
std::array<SwingResult, max_designs> results;
std::array<Field, max_fields> fields;
std::array<double, max_designs * max_fields> values;
// As engine.js reads and writes them.
static_assert(sizeof(Design<double>) == 3 * sizeof(double) && sizeof(Field) == 4);
static_assert(sizeof(SwingResult) == 32 && offsetof(SwingResult, speed) == 0 &&
              offsetof(SwingResult, release_time) == 8 && offsetof(SwingResult, steps) == 16 &&
              offsetof(SwingResult, status) == 24 && sizeof(Status) == 1);

/// The shared arrays as a batch.
Batch shared_batch(std::size_t count, std::size_t field_count) {
  return {std::span(designs).first(count), std::span(results).first(count),
          std::span(fields).first(field_count), std::span(values).first(count * field_count)};
}

std::string quoted(std::string_view text) { return '"' + std::string(text) + '"'; }

/// The names of a list, in JSON.
template <class List, class F>
std::string json_list(const List& list, F item) {
  std::string text;
  for (const auto& element : list) text += (text.empty() ? "[" : ",") + item(element);
  return text + "]";
}

}  // namespace

extern "C" {

/// Keys, the names of their choices, statuses, fields and columns of the rows, as JSON.
[[clang::export_name("describe")]] const char* describe() {
  static const std::string text =
      "{\"keys\":" + json_list(keys, [](const Key& key) { return quoted(key.name); }) +
      ",\"statuses\":" + json_list(status_names, quoted) +
      ",\"statusMeanings\":" + json_list(status_meanings, quoted) +
      ",\"choices\":{\"scene.trough\":[\"no\",\"yes\"],\"scene.beam-inertia\":" +
      json_list(beam_inertia_names, quoted) +
      ",\"solver.release\":" + json_list(release_names, quoted) + "},\"fields\":" +
      json_list(field_info,
                [](const FieldInfo& field) {
                  return "{\"name\":" + quoted(field.name) +
                         ",\"meaning\":" + quoted(field.meaning) + "}";
                }) +
      ",\"columns\":" + quoted(row_names) + ",\"flightColumns\":" + quoted(flight_row_names) +
      ",\"maxDesigns\":" + std::to_string(max_designs) + "}";
  return text.c_str();
}

[[clang::export_name("get_key")]] double get_key(std::size_t index) { return keys[index].get(); }
[[clang::export_name("set_key")]] void set_key(std::size_t index, double value) {
  keys[index].set(value);
}

[[clang::export_name("designs_address")]] void* designs_address() { return designs.data(); }
[[clang::export_name("results_address")]] void* results_address() { return results.data(); }
[[clang::export_name("fields_address")]] void* fields_address() { return fields.data(); }
[[clang::export_name("values_address")]] void* values_address() { return values.data(); }
[[clang::export_name("rows_address")]] void* rows_address() { return rows.data(); }
[[clang::export_name("flight_address")]] void* flight_address() { return flight_rows.data(); }
[[clang::export_name("flight_count")]] std::size_t flight_count() { return flight_row_count; }

/// Integrates the first designs; see Batch for `results` and `values`.
[[clang::export_name("integrate")]] void integrate(std::size_t count, std::size_t field_count,
                                                   double tolerance) {
  solver.tolerance = tolerance;
  with_general_effects(
      scene, [=]<Effects E>() { integrate_batch<E>(shared_batch(count, field_count), nullptr); });
}

/// See trace_swing().
[[clang::export_name("trace")]] std::size_t trace(std::size_t field_count, double tolerance) {
  solver.tolerance = tolerance;
  std::size_t count = 0;
  with_general_effects(scene,
                       [&]<Effects E>() { count = trace_swing<E>(shared_batch(1, field_count)); });
  return count;
}

}  // extern "C"

}  // namespace trebsweep::explorer

// Errors of the program itself end the module: nothing catches exceptions.
extern "C" void* __cxa_allocate_exception(std::size_t) { __builtin_trap(); }
extern "C" void __cxa_throw(void*, void*, void*) { __builtin_trap(); }
