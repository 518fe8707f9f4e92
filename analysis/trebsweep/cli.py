"""The command treb-plot."""

import importlib
import sys

from .program import note, run

COMMANDS = {
    "heatmap": "a map in planes through its best design",
    "trajectory": "a traced swing and its flight",
    "animation": "a traced swing that moves",
    "loads": "the loads along the swings of the best designs",
    "compare": "the difference of two archives",
    "study": "the optimum of each scene of a study",
    "histogram": "how often the values of a map occur",
    "importance": "how much of a map's variance comes from each key and length",
    "rules": "what it costs to follow rules of thumb",
    "pareto": "a trade-off of two objectives",
    "neighbourhood": "the objective around a job's optimum",
    "sheet": "a page to build a job's optimum from",
    "optimum": "prints an archive's optimum as options of trebsweep trace",
    "assess": "error against run time, orders and stable steps of an assessment",
    "machine": "a sketch of the machine with its symbols",
}


def usage():
    """What treb-plot --help prints."""
    width = max(map(len, COMMANDS))
    return "\n".join(["usage: treb-plot SUBCOMMAND [options]; treb-plot SUBCOMMAND --help", "", "Draws, or prints:",
                      *(f"  {name:{width}}  {text}" for name, text in COMMANDS.items())])


def main():
    """Runs a subcommand."""
    name = sys.argv[1] if len(sys.argv) > 1 else ""
    if name in ("-h", "--help"):
        print(usage())
        sys.exit(0)
    if name not in COMMANDS:
        note(f"treb-plot: {name or 'no subcommand'}: must be one of {', '.join(COMMANDS)}")
        sys.exit(2)
    sys.argv[:2] = [f"treb-plot {name}"]
    run(lambda: importlib.import_module(f".{name}", __package__).main())
