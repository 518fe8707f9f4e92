#include "trebsweep/archive/file_lock.hpp"

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "support/catch.hpp"
#include "trebsweep/base/error.hpp"

using namespace trebsweep;

namespace {

const std::filesystem::path path = TEST_DIR "/lock_of_" + std::to_string(getpid());

/// Tries to take the lock in another process: returns its error message, empty if it succeeds.
std::string lock_in_other_process() {
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

std::string content(const std::filesystem::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

TEST_CASE("A held lock refuses another process and names the holder") {
  {
    const FileLock lock(path);
    CHECK_THAT(lock_in_other_process(), contains(path) && contains(std::to_string(getpid())));
    CHECK(content(path).starts_with("trebsweep lock: process "));
  }
  CHECK_FALSE(std::filesystem::exists(path));
  CHECK(lock_in_other_process().empty());
}

TEST_CASE("A lock is released when its process is killed") {
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

TEST_CASE("A lock file that cannot be created is an error") {
  CHECK_THROWS_AS(FileLock("/nowhere/a.lock"), std::system_error);
}

TEST_CASE("A file that is not a lock file is refused and left unchanged") {
  std::ofstream(path) << "precious";
  CHECK_THROWS_AS(FileLock(path), InputError);
  CHECK_FALSE(lock_holder(path));
  CHECK(content(path) == "precious");
  std::filesystem::remove(path);
}

TEST_CASE("An empty file can be locked and is left in place") {
  std::ofstream{path};
  {
    const FileLock lock(path);
    CHECK_THAT(lock_in_other_process(), contains("another process"));
  }
  CHECK(std::filesystem::exists(path));
  CHECK(content(path).empty());
  std::filesystem::remove(path);
}

TEST_CASE("A symbolic link is not followed, and a FIFO does not block") {
  const std::filesystem::path target = path.string() + ".target";
  std::ofstream(target) << "precious";
  std::filesystem::create_symlink(target, path);
  CHECK_THROWS(FileLock(path));
  CHECK_FALSE(lock_holder(path));
  CHECK(content(target) == "precious");
  std::filesystem::remove(path);
  std::filesystem::remove(target);
  REQUIRE(mkfifo(path.c_str(), 0600) == 0);
  CHECK_THROWS_AS(FileLock(path), InputError);
  CHECK_FALSE(lock_holder(path));
  std::filesystem::remove(path);
}
