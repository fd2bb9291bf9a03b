#include "run_program.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <stdexcept>
#include <thread>

#include "temporary_folder.hpp"

namespace tri::test {

Outcome run_tri(const std::vector<std::string>& arguments, const std::string& folder, const std::string& out_path,
                int interrupt_after_ms) {
  const TemporaryFolder captured;
  const std::string out = out_path.empty() ? captured / "out" : out_path, err = captured / "err";
  // As in main.cpp, for the program when it is built with the leak sanitizer.
  const std::string suppressions =
      captured.make("suppressions", "leak:libTKernel\nleak:libTKXSBase\nleak:libTKSTEP\nleak:libTKIGES\n");
  setenv("LSAN_OPTIONS", ("print_suppressions=0:suppressions=" + suppressions).c_str(), 1);
  std::vector<char*> words{const_cast<char*>(TRI_PROGRAM)};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) {  // only calls that are safe between fork and exec
    const int out_file = open(out.c_str(), O_WRONLY | O_CREAT, 0600),
              err_file = open(err.c_str(), O_WRONLY | O_CREAT, 0600);
    if (out_file < 0 || err_file < 0 || chdir(folder.c_str()) != 0) _exit(126);
    dup2(out_file, STDOUT_FILENO);
    dup2(err_file, STDERR_FILENO);
    execv(TRI_PROGRAM, words.data());
    _exit(127);
  }
  if (interrupt_after_ms > 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(interrupt_after_ms));
    kill(child, SIGINT);
  }
  int status = 0;
  if (waitpid(child, &status, 0) != child) throw std::runtime_error("waitpid failed");
  Outcome outcome;
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  if (out_path.empty()) outcome.out = file_bytes(out);
  outcome.err = file_bytes(err);
  return outcome;
}

}  // namespace tri::test
