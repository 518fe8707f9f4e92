#include "trebsweep/cli/stop_signals.hpp"

#include <signal.h>

#include <array>
#include <csignal>

namespace trebsweep {
namespace {

volatile std::sig_atomic_t stop_requested = 0;

void request_stop(int) { stop_requested = 1; }

constexpr std::array stop_signals{SIGINT, SIGTERM, SIGUSR1};

void set_handler(int number, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigaction(number, &action, nullptr);
}

}  // namespace

StopSignals::StopSignals() {
  stop_requested = 0;
  for (const int number : stop_signals) set_handler(number, request_stop);
  set_handler(SIGXFSZ, SIG_IGN);
}

StopSignals::~StopSignals() {
  for (const int number : stop_signals) set_handler(number, SIG_DFL);
  set_handler(SIGUSR1, SIG_IGN);  // one that arrives late must not end the program
  set_handler(SIGXFSZ, SIG_DFL);
}

bool StopSignals::requested() const { return stop_requested != 0; }

}  // namespace trebsweep
