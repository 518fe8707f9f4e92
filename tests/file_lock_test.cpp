#include "trebsweep/file_lock.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <system_error>

#include "catch.hpp"
#include "trebsweep/error.hpp"

using namespace trebsweep;

namespace {

const std::filesystem::path path = TEST_DIR "/lock_of_" + std::to_string(getpid());

/// What another process meets that wants the lock: its message, or nothing if it got it.
std::string other_process() {
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  const pid_t child = fork();
  if (child == 0) {
    std::string message;
    try {
      const FileLock lock(path);
    } catch (const InputError& error) {
      message = error.what();
    }
    _exit(write(ends[1], message.data(), message.size()) < 0);
  }
  close(ends[1]);
  int status = 1;
  waitpid(child, &status, 0);
  REQUIRE(status == 0);
  std::string message(1000, '\0');
  const auto length = read(ends[0], message.data(), message.size());
  close(ends[0]);
  message.resize(static_cast<std::size_t>(length));
  return message;
}

}  // namespace

TEST_CASE("A lock keeps another process out, and names its holder") {
  {
    const FileLock lock(path);
    CHECK_THAT(other_process(), contains(path) && contains(std::to_string(getpid())));
    CHECK(std::filesystem::exists(path));
  }
  CHECK_FALSE(std::filesystem::exists(path));
  CHECK(other_process().empty());
}

TEST_CASE("A lock dies with its process, however that ends") {
  const pid_t child = fork();
  if (child == 0) {
    const FileLock lock(path);
    kill(getpid(), SIGKILL);
  }
  waitpid(child, nullptr, 0);
  CHECK(std::filesystem::exists(path));
  { const FileLock lock(path); }
  CHECK_FALSE(std::filesystem::exists(path));
}

TEST_CASE("Where no file can be, there is no lock") {
  CHECK_THROWS_AS(FileLock("/nowhere/a.lock"), std::system_error);
}
