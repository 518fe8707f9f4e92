"""Reading archives of trebsweep, and what the pictures have in common."""

import sys

import h5py
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of the backend)

AXES = ("r1", "r3", "r2")


class Archive:
    """An archive opened for reading: axes, the optimum, and planes of its maps."""

    def __init__(self, path):
        """Opens the HDF5 file at `path`; ends the program with a message if it is no archive."""
        self.path = path
        try:
            self.file = h5py.File(path, "r")
        except OSError as error:
            sys.exit(f"{path}: cannot be opened as an HDF5 file: {error}")
        missing = [name for name in AXES if name not in self.file]
        if missing:
            sys.exit(f"{path}: is no archive of trebsweep: it has no {missing[0]}")
        self.axes = {name: self.file[name][...] for name in AXES}

    @property
    def fields(self):
        """Names of the maps."""
        return [name for name, item in self.file.items()
                if isinstance(item, h5py.Dataset) and item.ndim == 3]

    def map(self, field):
        """The dataset of a map (r1, r3, r2); ends the program if there is none of that name."""
        name = field.replace("-", "_")
        if name not in self.fields:
            sys.exit(f"{self.path}: has no map {name}; it has {', '.join(self.fields)}")
        return self.file[name]

    def attribute(self, name):
        """A root attribute, or None."""
        return self.file.attrs.get(name)

    def job(self):
        """The job as {(section, key): value}."""
        values, section = {}, ""
        for line in (self.attribute("job") or "").splitlines():
            if line.startswith("["):
                section = line.strip("[]")
            elif "=" in line:
                key, value = line.split("=", 1)
                values[section, key.strip()] = value.strip()
        return values

    def optimum(self):
        """{axis: value in m} of the fastest design, or None if nothing was released."""
        best = {name: self.attribute(f"best_{name}") for name in AXES}
        return None if any(x is None or np.isnan(x) for x in best.values()) else best

    def index(self, axis, value):
        """The place of the axis's value nearest to `value`; ends the program outside the axis."""
        limits = edges(self.axes[axis])
        if not limits[0] <= value <= limits[-1]:
            sys.exit(f"{axis} = {value:g}: must be from {self.axes[axis][0]:g} to "
                     f"{self.axes[axis][-1]:g} m, as in {self.path}")
        return int(np.argmin(np.abs(self.axes[axis] - value)))

    def best(self):
        """The optimum as text."""
        optimum = self.optimum()
        if optimum is None:
            return "nothing released"
        return f"{self.attribute('best_speed'):.8f} m/s at {design_text(optimum)}"

    def label(self, name):
        """A label for an axis or a map: what it is, its name and its unit."""
        attributes = self.file[name].attrs
        unit = attributes.get("units")
        text = attributes.get("long_name", name)
        if name in AXES:
            text = f"{text} {name}"
        return f"{text} ({unit_text(unit)})" if unit else text


def design_text(design):
    """A design, {axis: value in m}, as people write it."""
    return ", ".join(f"{name} = {design[name]:g}" for name in ("r1", "r2", "r3")) + " m"


def unit_text(unit):
    """A UDUNITS string as people write it: "m s-1" -> "m/s", "s-1" -> "1/s"."""
    return "1/s" if unit == "s-1" else unit.replace(" s-1", "/s")


def edges(values):
    """The boundaries of cells around equally spaced values."""
    if len(values) == 1:
        half = 0.01 * abs(values[0]) or 0.01
        return np.array([values[0] - half, values[0] + half])
    half = (values[1] - values[0]) / 2
    return np.append(values - half, values[-1] + half)


def save(figure, path):
    """Writes a picture in the format of its suffix (png, svg, pdf, ...) and says so."""
    try:
        figure.savefig(path, dpi=150)
    except (OSError, ValueError) as error:
        sys.exit(f"{path}: cannot be written: {error}")
    plt.close(figure)
    print(path)
