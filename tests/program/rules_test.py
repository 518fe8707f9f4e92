"""Rules of thumb: treb-plot rules, its job files, and the commands of analysis/results/rules.md.

Needs TREBSWEEP (the program) in the environment.
"""

import contextlib
import copy
import io
import itertools
import os
import re
import shlex
import subprocess
import sys
import unittest
import unittest.mock

import h5py
import numpy as np

from scripts import ScriptTest  # first: it makes the modules of analysis/ importable
from trebsweep import Error, rules
from trebsweep.picture import plt
from trebsweep.scenes import load, select
from support import PROGRAM, REPOSITORY

PAGE = os.path.join(REPOSITORY, "analysis", "results", "rules.md")
RULES = {"r1 < r2": lambda r1, r3, r2, mass: r1 < r2,
         "abs(1.5 * r3 / r2 - 1) < 0.3": lambda r1, r3, r2, mass: abs(1.5 * r3 / r2 - 1) < 0.3,
         "~(r1 < 0.7) & (r2**2 + r3 >= 1)": lambda r1, r3, r2, mass: r1 >= 0.7 and r2**2 + r3 >= 1,
         "r1 > projectile_mass / 200": lambda r1, r3, r2, mass: r1 > mass / 200}


class Rules(ScriptTest):
    """rules.h5, a study of 3 x 2 scenes."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sweep("accurate", "--scene.projectile-mass", "50,100,200", "--scene.release-height", "1.8,2",
                  "--output.fields", "speed, status", name="rules", increment="0.1")

    def findings(self, free=(), among="~(r2 >= 0.8)"):
        value, considered, shown = (rules.Expression("test", text) for text in ("speed * r2", among, "r1"))
        return rules.Findings(select(load(self.path("rules.h5")), ()), free, value, considered, [shown],
                              [rules.Expression("rule", text) for text in RULES])

    def designs(self, i, j):
        """(value, (r1, r3, r2, projectile mass)) of the released designs of a scene with r2 < 0.8 m."""
        with h5py.File(self.path("rules.h5")) as file:
            speed = file["speed"][i, j]
            axes, mass = [file[name][...] for name in ("r1", "r3", "r2")], file["projectile_mass"][i]
        for index in itertools.product(*map(range, speed.shape)):
            r1, r3, r2 = (axis[k] for axis, k in zip(axes, index))
            if speed[index] > 0 and r2 < 0.8:
                yield speed[index] * r2, (r1, r3, r2, mass)

    def assert_found(self, findings, scene, designs):
        best, design = max(designs)
        self.assertEqual(findings.best[scene], best)
        self.assertEqual(findings.shown[0][scene], design[0])
        for cost, follows in zip(findings.costs, RULES.values()):
            followers = [value for value, design in designs if follows(*design)]
            self.assertAlmostEqual(cost[scene], 1 - max(followers) / best, delta=1e-15)

    def test_costs_are_those_of_brute_force(self):
        findings = self.findings()
        for scene in itertools.product(range(3), range(2)):
            self.assert_found(findings, scene, list(self.designs(*scene)))
        self.assertGreater((findings.costs > 0).sum(), 5)

    def test_a_free_axis_is_chosen_with_the_design(self):
        by_height, by_mass = self.findings(["projectile_mass"]), self.findings(["release_height"])
        for j in range(2):
            self.assert_found(by_height, (j,), [design for i in range(3) for design in self.designs(i, j)])
        for i in range(3):
            self.assert_found(by_mass, (i,), [design for j in range(2) for design in self.designs(i, j)])
        both = self.findings(["release_height", "projectile_mass"])
        self.assert_found(both, (), [design for scene in itertools.product(range(3), range(2))
                                     for design in self.designs(*scene)])

    def test_the_tables_show_the_costs(self):
        findings = self.findings()
        done = self.run_script("rules", "rules.h5", "--value", "speed * r2", "--among", "r2 < 0.8",
                               "--show", "r1", *(word for rule in RULES for word in ("--rule", rule)))
        rows = [line.split() for line in done.stdout.splitlines()[1:7]]
        for row, scene in zip(rows, itertools.product(range(3), range(2))):
            self.assertEqual(row[2:], [f"{findings.best[scene]:.6g}", f"{findings.shown[0][scene]:.4g}",
                                       *(f"{cost[scene]:.1%}" for cost in findings.costs)])
        for rule, cost in zip(RULES, findings.costs):
            self.assertIn(f": {rule}\n  within 1 % of the best in {(cost <= 0.01).sum()} of 6 scenes; costs ",
                          done.stdout)

    def test_a_rule_that_no_design_follows_has_no_cost(self):
        done = self.run_script("rules", "rules.h5", "--rule", "r1 > 9", "-o", "none.png")
        self.assertIn("rule 1: r1 > 9\n  no design follows it in 6 of 6 scenes\n", done.stdout)
        self.assertNotIn("costs", done.stdout)
        self.assertEqual([line.split()[-1] for line in done.stdout.splitlines()[1:7]], ["-"] * 6)

    def test_costs_are_drawn_over_one_and_two_axes(self):
        for options in ((), ("--at", "release-height=2"), ("--free", "release-height")):
            self.run_script("rules", "rules.h5", "--rule", "r1 < r2", "--rule", "r1 > 9", *options, "-o", "costs.png")
            self.assert_picture("costs.png")

    def test_the_colour_bar_says_where_costs_are_beyond_its_scale(self):
        archive = select(load(self.path("rules.h5")), ())
        findings = self.findings()
        for factor, beyond in ((0.4 / np.nanmax(findings.costs), False), (1.02 / np.nanmax(findings.costs), True)):
            scaled = copy.copy(findings)
            scaled.costs = factor * findings.costs
            figure = rules.draw(archive, scaled, [rules.Expression("rule", text) for text in RULES])
            self.addCleanup(plt.close, figure)
            panels, bar = figure.axes[:len(RULES)], figure.axes[-1]
            for axes, cost in zip(panels, scaled.costs):
                np.testing.assert_allclose(axes.images[0].get_array(), 100 * cost.T)
                self.assertEqual(axes.images[0].get_clim(), (0, 40))
            self.assertEqual(axes.images[0].colorbar.extend, "max" if beyond else "neither")
            self.assertEqual(bar.get_ylabel(), "cost (%); arrow: more than 40 %" if beyond else "cost (%)")

    def test_bad_options_are_refused(self):
        for options, says in (
                (("--rule", "nope < 1"), "rule = nope < 1: nope must be one of "),
                (("--show", "spede"), "show = spede: spede must be one of "),
                (("--rule", "r1 <"), "rule = r1 <: must be an expression"),
                (("--rule", "r3 / r2"), "rule = r3 / r2: must be true or false"),
                (("--among", "r1"), "among = r1: must be true or false"),
                (("--rule", "~r1"), "must combine comparisons"),
                (("--rule", "(r1 < r2) & r3"), "must combine comparisons"),
                (("--free", "gravity"), "free = gravity: must be an outer axis"),
                (("--free", "release-height", "--at", "release-height=2"), "free = release-height: must be"),
                (("--at", "release-height=3"), "at = release-height=3: must be one of"),
                (("--rule", "r1 < r2", "-o", "rules.h5"), "rules.h5"),
                (("-o", "costs.png"), "output = costs.png: needs a rule"),
                (("--rule", "r1 < r2", "--free", "release-height", "--at", "projectile-mass=50", "-o", "costs.png"),
                 "output = costs.png: needs a rule")):
            with self.subTest(options=options):
                self.run_script("rules", "rules.h5", *options, code=2, says=says)

    def test_expressions_can_only_compute(self):
        archive = load(self.path("rules.h5")).only([("projectile-mass", 50), ("release-height", 2)])
        for text in ("r1.real > 0", "().__class__", "__builtins__ > 0", "__import__('os')", "open('file')",
                     "eval('1')", "sqrt.at > 0", "[r1][0] > 0", "(lambda: r1)()", "r1 if r1 else r2", "(x := r1) > 0",
                     "f'{r1}'", "'text' < r1", "r1 < 1j", "r1 < True", "abs(r1, r2)", "abs(x=r1)", "abs(*r1)",
                     "sum(r1)", "sqrt > 0", "r1 < r2 < r3", "r1 < 1 and r2 < 1", "not r1", "r1 % 2", "r1 @ r2",
                     "1" + 400 * "0", 3000 * "-" + "1", 300 * "("):
            with self.subTest(text=text[:40]), self.assertRaises(Error) as refusal:
                rules.Expression("rule", text).values(archive.data)
            self.assertEqual(refusal.exception.code, 2)
            self.assertTrue(str(refusal.exception).startswith(f"rule = {' '.join(text.split())}: "), refusal.exception)


class RulesPage(ScriptTest):
    """The page's commands, as bash runs them: [words], without running the programs."""

    RECORD = "\n".join(f"{name}() {{ {body}; }}" for name, body in {
        "cmake": ":", "mpirun": 'shift 2; "$@"', "python3": "cat > /dev/null",
        **{name: f"printf '%q ' {name} \"$@\" >> commands; echo >> commands"
           for name in ("trebsweep", "analysis/treb-plot")}}.items())

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        with open(PAGE, encoding="utf-8") as file:
            cls.blocks = re.findall(r"```sh\n(.*?)```", file.read(), re.DOTALL)
        subprocess.run(["bash", "-c", f"{cls.RECORD}\n{''.join(cls.blocks)}"], cwd=cls.directory, check=True,
                       capture_output=True, timeout=60)
        cls.commands = [shlex.split(line) for line in cls.read("commands").decode().splitlines()]
        cls.sweep("rules", increment="0.1")
        cls.sweep("literature", "--lattice.r3", "4:9:2.5", increment="0.8")

    def test_every_option_exists(self):
        self.assertGreater(len(self.blocks), 5)
        self.assertGreater(len(self.commands), 20)
        usages = {}
        for program, *words in self.commands:
            command = (PROGRAM, words[0]) if program == "trebsweep" else (
                sys.executable, "-B", os.path.join(REPOSITORY, program), words[0])
            if command not in usages:
                usages[command] = "".join(self.run_command(*command, option).stdout for option in (
                    ("--help", "--help-keys") if program == "trebsweep" else ("--help",)))
            for option in words:
                if option.startswith("-") and not option[1:2].isdigit():
                    self.assertRegex(usages[command], rf"(?m)(^|[\s,]){re.escape(option)}(?![\w-])", program)

    def test_the_job_files_are_the_studies_of_the_page(self):
        for job, scenes in (("rules", 168), ("literature", 240)):
            with h5py.File(self.path(f"{job}.h5")) as file:
                self.assertEqual(file["best_value"].size, scenes)

    def test_the_expressions_are_about_what_the_archives_hold(self):
        own = [words for program, subcommand, *words in self.commands
               if subcommand == "rules" and words[0] in ("rules.h5", "literature.h5")]
        self.assertGreaterEqual(len(own), 8)
        for words in own:
            arguments = [self.path(word) if word.endswith((".h5", ".png")) else word for word in words]
            with self.subTest(words=words), unittest.mock.patch("sys.argv", ["rules", *arguments]), \
                    contextlib.redirect_stdout(io.StringIO()) as out:
                rules.main()
            self.assertEqual(len(re.findall(r"(?m)^rule \d+: ", out.getvalue())), words.count("--rule"))


if __name__ == "__main__":
    unittest.main()
