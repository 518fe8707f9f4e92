#include "trebsweep/archive/file_lock.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <system_error>

#include "support/catch.hpp"
#include "support/temporary_directory.hpp"
#include "trebsweep/base/error.hpp"

using namespace trebsweep;
namespace fs = std::filesystem;

namespace {

/// Calls f in another process and returns its result.
template <class F>
std::string in_other_process(F f) {
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  const pid_t child = fork();
  if (child == 0) {
    const std::string text = f();
    _exit(write(ends[1], text.data(), text.size()) < 0);
  }
  close(ends[1]);
  int status = 1;
  waitpid(child, &status, 0);
  REQUIRE(status == 0);
  std::string text(1000, '\0');
  const auto length = read(ends[0], text.data(), text.size());
  close(ends[0]);
  text.resize(static_cast<std::size_t>(length));
  return text;
}

/// Tries to take the lock in another process: returns its error message, empty if it succeeds.
std::string lock_in_other_process(const fs::path& folder) {
  return in_other_process([&]() -> std::string {
    try {
      const FileLock lock(folder);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  });
}

/// Locks a folder again and again, as long as no other process does. Returns whether all went well.
bool locks_often(const fs::path& folder, const fs::path& held) {
  for (int n = 0; n < 1000; ++n) {
    try {
      const FileLock lock(folder);
      const int file = open(held.c_str(), O_CREAT | O_EXCL, 0600);
      if (file < 0) return false;
      close(file);
      fs::remove(held);
    } catch (const InputError&) {  // another process holds it
    } catch (const std::exception&) {
      return false;
    }
  }
  return true;
}

}  // namespace

TEST_CASE("A held lock refuses another process and names the holder") {
  const TemporaryDirectory directory;
  const fs::path folder = directory / "a.partial";
  {
    const FileLock lock(folder);
    CHECK_THAT(lock_in_other_process(folder),
               contains(folder) && contains(std::to_string(getpid())));
    CHECK_THAT(in_other_process([&] { return lock_holder(folder).value_or("nobody"); }),
               contains("process " + std::to_string(getpid()) + " on "));
  }
  CHECK(lock_in_other_process(folder).empty());
}

TEST_CASE("The end of a lock removes its file, and the folder if it is empty") {
  const TemporaryDirectory directory;
  const fs::path folder = directory / "a.partial";
  { const FileLock lock(folder); }
  CHECK(fs::is_empty(directory.path()));
  fs::create_directory(folder);
  write_file(folder / "notes.txt", "precious");
  { const FileLock lock(folder); }
  CHECK_FALSE(fs::exists(folder / lock_name));
  CHECK(read_file(folder / "notes.txt") == "precious");
}

TEST_CASE("A lock is released when its process is killed, which leaves its file") {
  const TemporaryDirectory directory;
  const fs::path folder = directory / "a.partial";
  const pid_t child = fork();
  if (child == 0) {
    const FileLock lock(folder);
    kill(getpid(), SIGKILL);
  }
  waitpid(child, nullptr, 0);
  CHECK(fs::exists(folder / lock_name));
  CHECK_FALSE(lock_holder(folder));
  {
    const FileLock lock(folder);
    CHECK_THAT(lock_in_other_process(folder), contains(std::to_string(getpid())));
  }
  CHECK_FALSE(fs::exists(folder));
}

TEST_CASE("Of processes that lock a folder at the same time, one at a time holds the lock") {
  const TemporaryDirectory directory;
  std::vector<pid_t> children;
  for (int n = 0; n < 4; ++n) {
    children.push_back(fork());
    if (children.back() == 0)
      _exit(locks_often(directory / "a.partial", directory / "held") ? 0 : 1);
  }
  for (const pid_t child : children) {
    int status = 1;
    waitpid(child, &status, 0);
    CHECK(status == 0);
  }
}

TEST_CASE("A lock whose file cannot be created is an error") {
  CHECK_THROWS_AS(FileLock("/nowhere/a.partial"), std::system_error);
  const TemporaryDirectory directory;
  const fs::path file = directory / "a.partial";
  write_file(file, "precious");
  CHECK_THROWS_AS(FileLock(file), std::system_error);
  CHECK_FALSE(lock_holder(file));
  CHECK(read_file(file) == "precious");
}

TEST_CASE("A symbolic link is not followed, and a FIFO does not block") {
  const TemporaryDirectory directory;
  const fs::path target = directory / "target", folder = directory / "a.partial";
  write_file(target, "precious");
  fs::create_directory(folder);
  fs::create_symlink(target, folder / lock_name);
  CHECK_THROWS_AS(FileLock(folder), std::system_error);
  CHECK_FALSE(lock_holder(folder));
  CHECK(read_file(target) == "precious");
  fs::remove(folder / lock_name);
  REQUIRE(mkfifo((folder / lock_name).c_str(), 0600) == 0);
  CHECK_FALSE(lock_holder(folder));
}
