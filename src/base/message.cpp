#include "trebsweep/base/message.hpp"

#include <cerrno>
#include <cstdio>

namespace trebsweep {

void print_message(const std::string& text) {
  // fmt::print would throw.
  static_cast<void>(std::fwrite(text.data(), 1, text.size(), stderr));
}

void print_result(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) < text.size() || std::fflush(stdout) != 0)
    throw OutputError(errno, std::generic_category());
}

}  // namespace trebsweep
