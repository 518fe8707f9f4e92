#include "trebsweep/base/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace trebsweep {

void refuse(const std::string& key, const std::string& value, const std::string& allowed) {
  throw InputError(fmt::format("{} = {}: must be {}", key, shortened(value), allowed));
}

std::string shortened(const std::string& text) {
  constexpr std::size_t max_length = 200;
  return text.size() <= max_length ? text : text.substr(0, max_length) + "...";
}

std::string printable(std::string text) {
  const auto is_control = [](unsigned char c) { return std::iscntrl(c) != 0; };
  std::replace_if(text.begin(), text.end(), is_control, '?');
  return text;
}

}  // namespace trebsweep
