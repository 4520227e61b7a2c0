// SPDX-License-Identifier: MIT
#include "offline/report/gnuplot.hpp"

#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <thread>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace mdhcal::offline {

namespace {

// Descriptors that close themselves.
class Pipe {
 public:
  Pipe() { open_ = pipe2(ends_, O_CLOEXEC) == 0; }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  bool open() const { return open_; }
  int read_end() const { return ends_[0]; }
  int write_end() const { return ends_[1]; }
  void close_end(int which) {
    if (open_ && ends_[which] >= 0) close(ends_[which]);
    ends_[which] = -1;
  }

 private:
  int ends_[2] = {-1, -1};
  bool open_ = false;
};

using Clock = std::chrono::steady_clock;

// A picture of some thousand points is a megabyte; a program that prints without end is stopped here.
constexpr std::size_t most_output = std::size_t{1} << 28;

int milliseconds_until(Clock::time_point end) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
  return left > 0 ? static_cast<int>(left) : 0;
}

// Sends `input` to the program and returns what it prints, reading and writing in turn so that neither side waits. False if it
// has not ended its output by the deadline, or prints too much.
bool exchange_with(Pipe& to, Pipe& from, const std::string& input, std::string& output, Clock::time_point end) {
  std::size_t sent = 0;
  char buffer[65536];
  if (input.empty()) to.close_end(1);
  fcntl(to.write_end(), F_SETFL, O_NONBLOCK);
  while (true) {
    pollfd waits[2] = {{from.read_end(), POLLIN, 0}, {to.write_end(), POLLOUT, 0}};
    const int ready = poll(waits, 2, milliseconds_until(end));
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0 || Clock::now() >= end || output.size() > most_output) return false;
    if ((waits[1].revents & (POLLERR | POLLHUP)) != 0) to.close_end(1);
    if ((waits[1].revents & POLLOUT) != 0) {
      const ssize_t count = write(to.write_end(), input.data() + sent, input.size() - sent);
      if (count > 0) sent += static_cast<std::size_t>(count);
      if (sent == input.size() || (count < 0 && errno != EAGAIN && errno != EINTR)) to.close_end(1);
    }
    if ((waits[0].revents & (POLLIN | POLLHUP)) != 0) {
      const ssize_t count = read(from.read_end(), buffer, sizeof buffer);
      if (count == 0) return true;
      if (count > 0) output.append(buffer, static_cast<std::size_t>(count));
    }
  }
}

// The exit status of the child as waitpid() tells it; killed, with all that it started, if it has not ended by the deadline.
int wait_for(pid_t child, Clock::time_point end) {
  int status = 0;
  pid_t ended = 0;
  while ((ended = waitpid(child, &status, WNOHANG)) == 0 && Clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  if (ended == child) return status;
  kill(-child, SIGKILL);
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

bool run_gnuplot(const std::string& script, std::string& output, std::string& reason, std::chrono::milliseconds at_most) {
  const Clock::time_point end = Clock::now() + at_most;
  Pipe to, from;
  if (!to.open() || !from.open()) {
    reason = "no pipe could be opened";
    return false;
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, to.read_end(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, from.write_end(), STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  // Named as a file, standard input is read in blocks; else gnuplot asks the system for every character of it.
  char program[] = "gnuplot", no_defaults[] = "-d", script_file[] = "/dev/stdin";
  char* arguments[] = {program, no_defaults, script_file, nullptr};
  pid_t child = 0;
  // A program that dies early must not kill this one by the signal for a broken pipe.
  struct sigaction ignore = {}, before = {};
  ignore.sa_handler = SIG_IGN;
  sigaction(SIGPIPE, &ignore, &before);
  // In a process group of its own, so that what a wrapper starts is stopped with it.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  const int error = posix_spawnp(&child, program, &actions, &attributes, arguments, environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  to.close_end(0);
  from.close_end(1);
  bool done = false;
  if (error != 0) {
    reason = std::string("gnuplot cannot be started: ") + std::strerror(error);
  } else {
    done = exchange_with(to, from, script, output, end);
    if (!done) kill(-child, SIGKILL);
    const int status = wait_for(child, end);
    // The C library of some systems reports a missing program by exit status 127 only.
    if (!done || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
      done = false;
      reason = WIFEXITED(status) && WEXITSTATUS(status) == 127 ? "gnuplot was not found"
               : Clock::now() >= end                           ? "gnuplot did not end in time and was stopped"
                                                               : "gnuplot failed";
    }
  }
  sigaction(SIGPIPE, &before, nullptr);
  return done;
}

// In one pass: to replace in place would move the rest of the text at every place.
void replace_all(std::string& text, const std::string& from, const std::string& to) {
  std::string out;
  out.reserve(text.size() + text.size() / 8);
  std::size_t done = 0;
  for (std::size_t at = 0; (at = text.find(from, done)) != std::string::npos; done = at + from.size()) {
    out.append(text, done, at - done).append(to);
  }
  text = out.append(text, done);
}

}  // namespace

std::vector<std::string> draw(const std::vector<Figure>& figures, std::string& reason, std::chrono::milliseconds at_most) {
  std::string script = "set encoding utf8\n";
  for (const Figure& figure : figures) {
    script += "reset session\nset terminal svg enhanced size " + std::to_string(figure.width) + ',' +
              std::to_string(figure.height) + " font 'sans-serif,12' background 'white'\n" + figure.script +
              "\nunset output\n";
  }
  std::string output;
  if (!run_gnuplot(script, output, reason, at_most)) return {};
  std::vector<std::string> drawn;
  for (std::size_t at = output.find("<svg"); at != std::string::npos; at = output.find("<svg", at)) {
    const std::size_t end = output.find("</svg>", at);
    if (end == std::string::npos) break;
    std::string svg = output.substr(at, end + 6 - at);
    const std::string prefix = "f" + std::to_string(drawn.size()) + "_";
    if (drawn.size() < figures.size()) {
      replace_all(svg, "<title>Gnuplot</title>", "<title>" + figures[drawn.size()].title + "</title>");
    }
    replace_all(svg, "id=\"", "id=\"" + prefix);
    replace_all(svg, "id='", "id='" + prefix);
    replace_all(svg, "href='#", "href='#" + prefix);
    replace_all(svg, "href=\"#", "href=\"#" + prefix);
    replace_all(svg, "url(#", "url(#" + prefix);
    drawn.push_back(std::move(svg));
    at = end;
  }
  if (drawn.size() != figures.size()) {
    reason = "gnuplot drew " + std::to_string(drawn.size()) + " of " + std::to_string(figures.size()) + " figures";
    return {};
  }
  return drawn;
}

std::string data_block(const std::string& name, const std::vector<std::vector<double>>& rows) {
  std::string text = '$' + name + " << EOD\n";
  for (const auto& row : rows) {
    for (const double value : row) {
      char number[32];
      std::snprintf(number, sizeof number, std::isfinite(value) ? "%.7g " : "NaN ", value);
      text += number;
    }
    text += '\n';
  }
  return text + "EOD\n";
}

}  // namespace mdhcal::offline
