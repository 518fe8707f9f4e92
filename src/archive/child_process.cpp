#include "trebsweep/archive/child_process.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <system_error>

namespace trebsweep {
namespace {

/// Ends by f's own signals alone, without the messages of those who would report them.
[[noreturn]] void run(const std::function<void()>& f, unsigned working, unsigned seconds) {
  const rlimit no_core{0, 0}, processor{working, working + 1};
  setrlimit(RLIMIT_CORE, &no_core);
  setrlimit(RLIMIT_CPU, &processor);
  for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGALRM, SIGXCPU})
    std::signal(number, SIG_DFL);
  alarm(seconds);
  if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0) dup2(nowhere, STDERR_FILENO);
  try {
    f();
  } catch (...) {
  }
  _exit(0);
}

}  // namespace

bool completes_in_child(const std::function<void()>& f, unsigned working, unsigned seconds) {
  const pid_t child = fork();
  if (child < 0) throw std::system_error(errno, std::generic_category(), "fork");
  if (child == 0) run(f, working, seconds);
  int status = 0;
  while (waitpid(child, &status, 0) < 0)
    if (errno != EINTR) throw std::system_error(errno, std::generic_category(), "waitpid");
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM)
    throw std::system_error(ETIMEDOUT, std::generic_category());
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace trebsweep
