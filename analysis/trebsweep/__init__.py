"""Archives of trebsweep as xarray datasets, and its sweeps, optima and swings.

  import trebsweep
  ds = trebsweep.run("jobs/accurate.cfg", output_file="accurate.h5")    # or trebsweep.open("accurate.h5")
  ds.treb.best(10)
  ds.treb.heatmap("speed")
"""

from typing import TYPE_CHECKING

from .program import Error

if TYPE_CHECKING:
    from .api import Optimum, open_archive as open, optimum, run, trace  # pylint: disable=redefined-builtin

__all__ = ["Error", "Optimum", "open", "optimum", "run", "trace"]


def __getattr__(name: str):
    """Imports the functions, and xarray with them, at their first use: treb-plot reports missing packages itself."""
    if name in __all__:
        from . import api  # pylint: disable=import-outside-toplevel
        return getattr(api, "open_archive" if name == "open" else name)
    raise AttributeError(f"module {__name__} has no attribute {name}")
