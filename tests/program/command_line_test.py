"""What every command has in common: help, scene files, streams, stdin and the end of all ranks."""

import os
import re
import shutil
import signal
import subprocess
import time
import unittest

import h5py
import numpy as np

from commands import COARSE, DESIGN, SMALL_ASSESSMENT, CommandTest
from support import JOBS, MPIEXEC, PROGRAM, mpirun


class Help(CommandTest):
    def test_the_version_goes_to_stdout(self):
        self.assertRegex(self.run_program("--version").stdout,
                         r"^trebsweep \d+\.\d+\.\d+ \(.+\)\nkernel: .+ \(\d lanes\)\n$")

    def test_serial_commands_do_not_start_mpi(self):
        # Open MPI's MPI_Init fails if its message layer does not exist.
        broken = {"OMPI_MCA_pml": "missing"}
        if "Open MPI" not in subprocess.run([MPIEXEC, "--version"], capture_output=True, text=True,
                                            check=True).stdout:
            self.skipTest("can make only Open MPI's MPI_Init fail")
        self.assertNotEqual(self.run_program("sweep", self.job, *COARSE, code=None, environment=broken).returncode, 0)
        for arguments in (["--help"], ["--version"], ["sweep", "--help"], ["assess", "-h"], ["help", "optimum"],
                          ["optimum", "--help-keys"], ["completion"], ["man"], ["trace", self.job, *DESIGN], ["trace", "--help"]):
            self.assertTrue(self.run_program(*arguments, environment=broken).stdout)

    def test_every_process_of_a_launcher_runs_the_serial_commands(self):
        self.run_program("sweep", self.job, *COARSE)
        for arguments in (["--version"], ["--help"], ["info", "job.h5"], ["trace", self.job, *DESIGN]):
            alone = self.run_program(*arguments).stdout
            for variable in ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK", "SLURM_PROCID"):
                with self.subTest(arguments=arguments, variable=variable):
                    self.assertEqual(self.run_program(*arguments, environment={variable: "3"}).stdout, alone)


class Completion(CommandTest):
    """The script of bash, and the manual page."""

    def completed(self, *words):
        """What bash offers for the last of some words."""
        script = ('source <("$0" completion); COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _trebsweep; '
                  'printf "%s\\n" "${COMPREPLY[@]}"')
        return self.run_command("bash", "-c", script, PROGRAM, "trebsweep", *words).stdout.split()

    def test_every_key_and_option_is_offered(self):
        for command in ("sweep", "optimum", "trace", "assess"):
            offered = self.completed(command, "job.cfg", "--")
            text = self.run_program(command, "--help").stdout + self.run_program(command, "--help-keys").stdout
            listed = set(re.findall(r"^  (?:-. \[ )?(--[\w.-]+)", text, re.MULTILINE))
            self.assertGreater(len(listed), 40)
            self.assertEqual(set(offered), listed)

    def test_commands_values_and_keys_to_remove_are_offered(self):
        self.assertEqual(self.completed("s"), ["sweep"])
        self.assertEqual(self.completed("help", "a"), ["assess"])
        self.assertEqual(self.completed("sweep", "--solver.release", "f"), ["farthest", "fastest"])
        self.assertEqual(self.completed("trace", "--unset", "solver.tol"), ["solver.tolerance"])
        self.assertEqual(self.completed("sweep", "jo"), [])  # bash then completes names of files

    def test_man_has_no_warnings_about_the_manual_page(self):
        if not shutil.which("man"):
            self.skipTest("needs man")
        self.write("trebsweep.1", self.run_program("man").stdout)
        done = self.run_command("man", "-l", "--warnings", "-P", "cat", self.path("trebsweep.1"), MANWIDTH="100")
        self.assertEqual(done.stderr, "")
        self.assertIn("scene.gravity NUMBER", done.stdout)


class Precedence(CommandTest):
    def test_a_scene_file_given_as_an_option_changes_the_papers_sweep(self):
        wood = os.path.join(JOBS, "scenes", "wood.cfg")
        done = self.run_program("sweep", os.path.join(JOBS, "paper.cfg"), "--scene.file", wood, *COARSE)
        self.assertIn(f"scene     {wood}: beam-density = 700, beam-side = 0.2, beam-inertia = prism",
                      done.stdout)
        self.assertIn("solver    euler, time step 0.01 s", done.stdout)
        info = self.run_program("info", "paper.h5").stdout
        for line in done.stdout.splitlines():
            if line.startswith(("scene ", "solver ")):
                self.assertIn(line, info)


class Streams(CommandTest):
    """Results and exit codes do not depend on whether messages can be read, but on whether results can."""

    BROKEN = {"closed": "2>&-", "full": "2>/dev/full", "without a reader": "2> >(exec true)"}
    UNDERGROUND = ("--r1", "0.51", "--r2", "2", "--r3", "0.58")

    def test_no_exit_code_depends_on_stderr(self):
        # Each of them prints messages. The progress bar does so while the archive is open.
        coarse = (self.job, "--lattice.increment", "0.05", "--progress", "bar")
        commands = {
            ("sweep", *coarse, "--time-limit", "1e-6"): 75,
            ("sweep", *coarse): 0,
            ("sweep", *coarse, "--output.file", "again.h5", "--lattice.r1", "0.6"): 0,
            ("sweep", "missing.cfg"): 2,
            ("info", "job.h5", "--verify", "--progress", "bar"): 0,
            ("info", "missing.h5"): 2,
            ("trace", self.job, *DESIGN, "--solver.max-time", "0.3"): 0,
            ("trace", self.job, *self.UNDERGROUND): 0,
            ("optimum", self.job, "--progress", "bar"): 0,
            ("optimum", self.job, "--optimum.subject-to", "speed >= 1e6"): 3,
            ("assess", self.job, *SMALL_ASSESSMENT, "--output.file", "assess.h5"): 0,
        }
        for name, redirection in self.BROKEN.items():
            self.setUp()
            for command, code in commands.items():
                with self.subTest(stderr=name, command=command):
                    self.redirected(redirection, PROGRAM, *command, code=code)
            self.run_program("info", "job.h5", "--verify")

    def test_ranks_without_stderr_write_an_intact_archive(self):
        for code, options in ((75, ["--time-limit", "1e-6"]), (0, [])):
            self.run_command(*mpirun(2), "bash", "-c", 'exec "$@" 0<&- 2>&-', "bash", PROGRAM, "sweep", self.job,
                             *COARSE, *options, code=code)
        self.run_program("info", "job.h5", "--verify")

    def test_stdout_that_cannot_be_written_is_an_error_of_every_command(self):
        self.run_program("sweep", self.job, *COARSE)
        for redirection, reason in ((">/dev/full", "No space left on device"), (">&-", "Bad file descriptor")):
            for command in (["--help"], ["sweep", "--help"], ["info", "job.h5"], ["trace", self.job, *DESIGN],
                            ["optimum", self.job, "--progress", "none"],
                            ["sweep", self.job, *COARSE, "--output.file", "other.h5", "--overwrite"]):
                with self.subTest(redirection=redirection, command=command):
                    done = self.redirected(redirection, PROGRAM, *command, code=1)
                    self.assertIn(f"trebsweep: cannot write to stdout: {reason}\n", done.stderr)

    def test_a_reader_that_leaves_ends_a_trace_silently(self):
        done = self.redirected("> >(exec true)", PROGRAM, "trace", self.job, *DESIGN, "--interval", "1e-5",
                               code=-signal.SIGPIPE)
        self.assertEqual(done.stderr, "")


class Stdin(CommandTest):
    """A job called - is read from stdin."""

    def test_a_sweep_of_stdin_is_that_of_the_file(self):
        self.run_program("sweep", self.job, *COARSE, "--output.file", "file.h5")
        expected = self.read("file.h5")
        for ranks in (None, 2):
            with self.subTest(ranks=ranks):
                done = self.run_command("bash", "-c", 'cat job.cfg | "$@"', "bash", *mpirun(ranks), PROGRAM, "sweep",
                                        "-", *COARSE, "--overwrite")
                self.assertIn("archive   job.h5\n", done.stdout)
                with h5py.File(self.path("job.h5")) as piped, h5py.File(self.path("file.h5")) as file:
                    np.testing.assert_array_equal(piped["speed"], file["speed"])
                    self.assertEqual(piped.attrs["job"], file.attrs["job"].replace("file.h5", "job.h5"))
        self.assertEqual(self.read("file.h5"), expected)

    def test_every_command_with_a_job_reads_stdin(self):
        for command, *options in (["trace", *DESIGN], ["optimum", "--json"]):
            with self.subTest(command=command):
                alone, piped = (self.redirected("<job.cfg", PROGRAM, command, job, *options).stdout
                                for job in (self.job, "-"))
                seconds = r'"seconds": [^,}]*'
                self.assertEqual(re.sub(seconds, "", piped), re.sub(seconds, "", alone))
        done = self.redirected("<job.cfg", PROGRAM, "assess", "-", *SMALL_ASSESSMENT)
        self.assertIn("scene job", done.stdout)
        self.assertEqual(sorted(os.listdir(self.directory)), ["job-assess.h5", "job.cfg"])

    def test_a_scene_file_is_relative_to_the_working_directory(self):
        self.write("moon.cfg", "[scene]\ngravity = 1.62\n")
        self.write("job.cfg", "[scene]\nfile = moon.cfg\n")
        done = self.redirected("<job.cfg", PROGRAM, "sweep", "-", *COARSE)
        self.assertIn("scene     moon.cfg: gravity = 1.62\n", done.stdout)

    def test_stdin_that_is_no_job_is_refused(self):
        self.write("binary", bytes(range(256)))
        self.write("long", "#" * (1 << 20) + "\n")
        self.write("words", "This is no job.\n")
        for redirection, words in (("<&-", " (stdin): Bad file descriptor"), ("</dev/null", " (stdin): is empty"),
                                   ("<binary", " (stdin): is not a text file"), ("<.", " (stdin): Is a directory"),
                                   ("<long", " (stdin): is longer than 1 MiB"),
                                   ("<words", ": line 1, 'This is no job.'")):
            for ranks in (None, 2):
                with self.subTest(redirection=redirection, ranks=ranks):
                    if ranks and redirection in ("<&-", "<."):
                        continue  # mpirun does not pass these on
                    done = self.redirected(redirection, *mpirun(ranks), PROGRAM, "sweep", "-", code=2)
                    self.assertEqual(done.stderr.count(f"trebsweep: job file -{words}"), 1, done.stderr)

    def test_a_signal_ends_a_sweep_that_waits_for_stdin(self):
        with subprocess.Popen([PROGRAM, "sweep", "-"], cwd=self.directory, stdin=subprocess.PIPE, text=True,
                              stderr=subprocess.PIPE) as sweep:
            time.sleep(0.5)
            for _ in range(50):  # one that arrives while MPI starts does not interrupt the wait
                if sweep.poll() is None:
                    sweep.send_signal(signal.SIGINT)
                    time.sleep(0.2)
            self.assertEqual(sweep.poll(), 2)
            self.assertIn("(stdin): Interrupted", sweep.stderr.read())


class BadInput(CommandTest):
    def test_all_ranks_end_together_with_one_message(self):
        done = self.run_program("sweep", self.job, "--scene.gravity", "-1", ranks=3, code=2)
        self.assertEqual(done.stderr.count("scene.gravity = -1"), 1)
        done = self.run_program("sweep", "missing.cfg", ranks=2, code=2)
        self.assertEqual(done.stderr.count("No such file"), 1)


if __name__ == "__main__":
    unittest.main()
