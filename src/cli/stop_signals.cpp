#include "trebsweep/cli/stop_signals.hpp"

#include <signal.h>

#include <array>
#include <csignal>

namespace trebsweep {
namespace {

volatile std::sig_atomic_t stop_came = 0;

void note_stop(int) { stop_came = 1; }

constexpr std::array stop_signals{SIGINT, SIGTERM, SIGUSR1};

void handle(int number, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigaction(number, &action, nullptr);
}

}  // namespace

StopSignals::StopSignals() {
  stop_came = 0;
  for (const int number : stop_signals) handle(number, note_stop);
  handle(SIGXFSZ, SIG_IGN);
}

StopSignals::~StopSignals() {
  for (const int number : stop_signals) handle(number, SIG_DFL);
  handle(SIGUSR1, SIG_IGN);  // what it asks for is done
  handle(SIGXFSZ, SIG_DFL);
}

bool StopSignals::requested() const { return stop_came != 0; }

}  // namespace trebsweep
