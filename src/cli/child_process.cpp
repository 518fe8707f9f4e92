#include "trebsweep/cli/child_process.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <system_error>

namespace trebsweep {
namespace {

/// The child. Default signal handlers and a discarded stderr keep MPI's and HDF5's handlers from
/// reporting a crash that is expected.
[[noreturn]] void run(const std::function<void()>& f, unsigned cpu_seconds, unsigned wall_seconds) {
  const rlimit no_core{0, 0}, cpu_time{cpu_seconds, cpu_seconds + 1};
  setrlimit(RLIMIT_CORE, &no_core);
  setrlimit(RLIMIT_CPU, &cpu_time);
  for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGALRM, SIGXCPU})
    std::signal(number, SIG_DFL);
  alarm(wall_seconds);
  if (const int null = open("/dev/null", O_WRONLY); null >= 0) dup2(null, STDERR_FILENO);
  try {
    f();
  } catch (...) {
  }
  _exit(0);
}

}  // namespace

bool completes_in_child(const std::function<void()>& f, unsigned cpu_seconds,
                        unsigned wall_seconds) {
  const pid_t child = fork();
  if (child < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (child == 0) run(f, cpu_seconds, wall_seconds);
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) throw std::system_error(errno, std::generic_category(), "waitpid");
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM)
    throw std::system_error(ETIMEDOUT, std::generic_category());
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace trebsweep
