#pragma once

#include <functional>
#include <string>
#include <vector>

namespace trebsweep {

/// A key of [scene] with several values: an axis of a study.
struct OuterAxis {
  std::string key;             ///< "scene.projectile-mass"
  std::vector<double> values;  ///< ascending, in the unit of the key
  std::string text;            ///< of the values in a job file: "50:200:10" or "1000, 2000, 5000"

  /// The key without its section: "projectile-mass".
  std::string name() const { return key.substr(key.find('.') + 1); }
};

/// Whether the text of a value is meant as several numbers.
bool has_several_values(const std::string& text);

/// The axis of the values first:last:step, including both ends, or of a list in any order, in a
/// unit. `parse` parses and checks a single number. Throws InputError naming the key, the text and
/// what is allowed, also if a value is repeated or there are more than 1e6.
OuterAxis to_outer_axis(const std::string& key, const std::string& text, const std::string& unit,
                        const std::function<double(const std::string&)>& parse);

}  // namespace trebsweep
